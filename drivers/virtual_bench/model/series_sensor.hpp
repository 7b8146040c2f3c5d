// A sensor that records a series after a trigger (TSS) on the virtual bench, with a clock and a
// start latency of its own.
//
// Sample n is taken at edge + latency + n / (nominal rate * rate_factor) and shows the acceleration
// of `delay` earlier, with the response, noise and quantisation of the sensor. Latency is 0, for a
// sensor that runs free uniform over one sample; start jitter scatters it from shot to shot. A
// sample that is lost is missing in the series, which goes on until it is full. A trigger during a
// series is ignored. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/virtual_bench/model/bench_faults.hpp"
#include "drivers/virtual_bench/model/channel_disturbance.hpp"
#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/preset.hpp"
#include "drivers/virtual_bench/model/random.hpp"
#include "drivers/virtual_bench/model/response.hpp"

namespace dyncal::drivers::virtual_bench {

struct SeriesSensorSettings {
  std::uint64_t seed = 1;
  AxisResponse response;
  double nominal_rate_hz = 1000.0;
  double rate_factor = 1.00305; // real rate / nominal rate: the paper's MPU-9250
  std::size_t samples = 1000;
  SeriesStart start;
  double noise_m_s2 = 0.04;
  double step_m_s2 = 0.0048; // of its converter
  double highest_level_m_s2 = 130.0;
  ChannelFaults faults;
  double loss = 0.0; // probability per sample; a series has no numbers that would show it
};

// The z axis of a preset, sound.
[[nodiscard]] SeriesSensorSettings series_sensor_of(const Preset& preset, std::uint64_t seed,
                                                    double range_m_s2);

struct RecordedSeries {
  std::uint64_t shot = 0; // triggers that the sensor has taken, from 1
  std::vector<std::int16_t> counts;
};

class SeriesSensor {
public:
  explicit SeriesSensor(SeriesSensorSettings settings);

  void trigger(double edge_s);
  // The series that is complete before `time_s`. REQUIRES: called at least once a second of bench
  // time.
  [[nodiscard]] std::optional<RecordedSeries> advance_to(double time_s,
                                                         const Excitation& excitation);

  [[nodiscard]] const SeriesSensorSettings& settings() const { return settings_; }
  [[nodiscard]] double real_rate_hz() const {
    return settings_.nominal_rate_hz * settings_.rate_factor;
  }
  // The line that precedes a series on the wire (drivers/tss/README.md), without its line end.
  [[nodiscard]] std::string header_line(std::uint64_t shot) const;
  [[nodiscard]] std::string wire_form(const RecordedSeries& series) const;

private:
  SeriesSensorSettings settings_;
  Random random_;
  Random loss_;
  ChannelDisturbance disturbance_;
  std::uint64_t shot_ = 0;
  bool recording_ = false;
  double first_sample_s_ = 0.0;
  std::size_t next_sample_ = 0; // of the series, with those that are lost
  std::vector<std::int16_t> counts_;
};

} // namespace dyncal::drivers::virtual_bench
