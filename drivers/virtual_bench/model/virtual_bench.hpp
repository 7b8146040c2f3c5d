// A whole bench without its cables: generator, exciter, ACS and SmartUp Unit, all functions of
// bench time and of one seed.
//
// Its owner moves bench time on with advance_to() and finds in the outputs what the instruments
// send; the generator's setting acts from the present bench time on. It knows nothing of sockets or
// of the host's clock. One thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/virtual_bench/model/acs_instrument.hpp"
#include "drivers/virtual_bench/model/bench_faults.hpp"
#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/preset.hpp"
#include "drivers/virtual_bench/model/response_file.hpp"
#include "drivers/virtual_bench/model/sensor_unit.hpp"

namespace dyncal::drivers::virtual_bench {

enum class GeneratorWords { dg4000, keysight_33500 }; // whose SCPI the generator speaks

struct BenchSettings {
  Preset preset;
  std::uint64_t seed = 1;
  std::int64_t acs_rate_hz = 20000;
  double highest_level_m_s2 = 130.0;
  double thermal_cycle_s = 100.0;
  double reference_magnitude_rel = 1e-3; // standard uncertainties that the recipe states
  double reference_phase_rad = 1.7e-3;
  GeneratorWords generator_words = GeneratorWords::dg4000;
  BenchFaults faults;
  std::optional<ResponseTable> response;                // of z, in place of the preset's
  bool acs_utc = false;                                 // the ACS stamps in UTC too
  bool sync_is_first_output = false;                    // see acs_instrument.hpp
  bool acs_pulses = false;                              // of a GPS receiver, in a third channel
  std::optional<InterferometerSettings> interferometer; // of the ACS, in place of its reference
  // The instant of bench time 0 in UTC: ACS and unit then keep UTC, as instruments with a GPS
  // receiver do, instead of epochs of their own.
  std::optional<std::int64_t> utc_origin_ns;
};

class VirtualBench {
public:
  static constexpr double level_per_volt = 50.0;   // m/s^2 per V, nominal
  static constexpr double sync_amplitude_v = 9.75; // 19.5 V peak to peak

  explicit VirtualBench(const BenchSettings& settings);

  [[nodiscard]] double now_s() const { return now_s_; }
  [[nodiscard]] const Drive& drive() const { return excitation_.drive(); }
  void set_drive(const Drive& drive) { excitation_.change(now_s_, drive); }
  // False where the response of the sensor is not known.
  [[nodiscard]] bool has_response_at(double frequency_hz) const {
    return !settings_.response || settings_.response->covers(frequency_hz);
  }

  // Samples up to `time_s` go to the two outputs in the order in which they were taken by each
  // instrument. REQUIRES: not before now_s(); steps of at most half a second.
  void advance_to(double time_s, AcsSamples& acs,
                  const std::function<void(const UnitSample&)>& unit);

  [[nodiscard]] const BenchSettings& settings() const { return settings_; }
  [[nodiscard]] const AcsInstrument& acs() const { return acs_; }
  [[nodiscard]] AcsInstrument& acs() { return acs_; }
  [[nodiscard]] const SensorUnit& unit() const { return unit_; }
  [[nodiscard]] const SyncAdcModel& adc() const { return adc_; }
  [[nodiscard]] const Excitation& excitation() const { return excitation_; }
  [[nodiscard]] const ExciterModel& exciter() const { return exciter_; }

private:
  BenchSettings settings_;
  ExciterModel exciter_;
  SyncAdcModel adc_;
  Excitation excitation_;
  AcsInstrument acs_;
  SensorUnit unit_;
  double now_s_ = 0.0;
};

} // namespace dyncal::drivers::virtual_bench
