// The benches that `dyncal demo` shows: for every preset of the virtual bench what is excited, and
// the bench file that goes with it. Plain functions, any thread.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dyncal::inline programs {

struct DemoPreset {
  std::string name;  // of the virtual bench's preset
  std::string shows; // one line for people
  std::vector<std::string> frequencies_hz;
  std::vector<double> levels_m_s2; // one per frequency
  int repetitions = 3;
  double settling_s = 0.5;
  double duration_s = 3.0;
  bool triggered = false; // series time stamping with oscilloscope and time series sensor
  bool trigger_phase_correction = true; // of every shot
  enum class CanLink { none, absolute_time, sync_beside };
  CanLink can = CanLink::none; // a sensor with CAN output, and what links it to the ACS
  bool laser = false;          // an interferometer in place of the reference channel
  // Of the virtual bench.
  [[nodiscard]] std::string sensor() const {
    return can == CanLink::none && !laser ? name : "mpu9250-ptb";
  }
};

[[nodiscard]] const std::vector<DemoPreset>& demo_presets();

// Leaves out the frequencies outside first_hz..last_hz; returns them.
[[nodiscard]] std::vector<std::string> keep_frequencies(DemoPreset& preset, double first_hz,
                                                        double last_hz);

struct DemoAddresses {
  std::string dau_listen;
  std::string acs;
  std::string generator;
  std::string oscilloscope; // presets that are triggered
  std::string sensor;
  std::string can_interface; // presets with CAN output
  std::string can_bus;       // of the virtual bench: "500k", "1M", "fd-5M"
};

// What the virtual bench draws its errors from, as in its truth file: the recipe must state the
// same.
struct DemoUncertainty {
  double reference_magnitude_rel = 0.0;
  double reference_phase_rad = 0.0;
  double acs_rate_rel = 0.0;
};

// Options of the virtual bench that give it the interferometer that the bench file states.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> laser_options();

[[nodiscard]] std::string demo_bench_file(const DemoPreset& preset, const std::string& bench,
                                          const DemoAddresses& addresses,
                                          const DemoUncertainty& uncertainty);

} // namespace dyncal::inline programs
