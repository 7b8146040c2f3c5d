// The sensors that the virtual bench can carry, with the numbers of their models.
//
//   mpu9250-paper  the unit of Seeger and Bruns, Acta IMEKO 10 (2021) 3: group delay 8.1 ms,
//                  interval 996.96 us, sd 21 ns, spread 335 ns
//   mpu9250-ptb    the unit of PTB's published calibration: magnitude and phase of 17 frequencies,
//                  delay 1.511 ms
//   bma280         interval 485 us with a late and an early sample every 2200 samples,
//                  delay 0.55 ms
//   tss            a sensor with the response of mpu9250-ptb that records series after a trigger;
//                  comes with an oscilloscope
//
// Excitation is along z; x and y see about 2 % of it, each through a transfer function of its own.
// Plain data; any thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "drivers/virtual_bench/model/response.hpp"

namespace dyncal::drivers::virtual_bench {

enum class SensorKind { mpu9250, bma280 };

struct Preset {
  std::string name;
  SensorKind sensor = SensorKind::mpu9250;
  bool triggered = false;          // z is measured by a time series sensor as well
  std::string sensor_name;         // as the unit's DSCP messages say it
  double nominal_rate_hz = 1000.0; // what the data sheet promises
  double mean_interval_s = 0.0;    // what the unit does
  double interval_sd_s = 0.0;
  double counts_per_range = 32768.0; // steps from 0 to the end of the range
  double noise_g_per_root_hz = 0.0;
  std::array<AxisResponse, 3> axes; // x, y, z
};

[[nodiscard]] std::optional<Preset> preset_by_name(const std::string& name);
[[nodiscard]] std::vector<std::string> preset_names();

} // namespace dyncal::drivers::virtual_bench
