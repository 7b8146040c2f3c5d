// A SmartUp Unit with one sensor: what it measures, when, and with which stamps.
//
// At every data-ready edge the unit stamps the sample, reads the sensor (which shows the
// acceleration of `delay` earlier, with its response, noise, offset and quantisation), and samples
// three ADCs. The first ADC sees the sync signal through its own lag and gain, with 12 bit of +-10
// V. One thread.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/virtual_bench/model/bench_faults.hpp"
#include "drivers/virtual_bench/model/channel_disturbance.hpp"
#include "drivers/virtual_bench/model/dau_clock.hpp"
#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/preset.hpp"
#include "drivers/virtual_bench/model/sensor_clock.hpp"
#include "drivers/virtual_bench/model/stamp_faults.hpp"
#include "drivers/virtual_bench/model/unit_sample.hpp"

namespace dyncal::drivers::virtual_bench {

struct SyncAdcModel {
  double gain = 0.166245; // reported volt per volt at the input
  double lag_s = 0.46e-6;
};

struct SensorUnitSettings {
  Preset preset;
  std::uint64_t seed = 1;
  std::int64_t start_ns = 0;         // unit time at bench time 0
  double highest_level_m_s2 = 130.0; // decides the range of the sensor
  double largest_magnitude = 1.0;    // of its response
  double widest_range_g = 16.0;
  double thermal_cycle_s = 100.0;
  double sync_amplitude_v = 9.75;
  bool sync_is_first_output = false;
  SyncAdcModel adc;
  ChannelFaults sensor_faults;
  DelayChange delay_change;
  ChannelFaults sync_faults;
  SampleLoss loss;
  StampFaultProbabilities stamp_faults;
  std::size_t fifo_samples = 0; // bench_faults.hpp
};

class SensorUnit {
public:
  explicit SensorUnit(const SensorUnitSettings& settings);

  [[nodiscard]] const std::vector<UnitChannel>& channels() const { return channels_; }
  [[nodiscard]] const DauClock& clock() const { return clock_; }
  [[nodiscard]] double range_m_s2() const { return range_m_s2_; }

  // The next sample when its edge lies before `time_s`; samples that the unit loses are left out.
  [[nodiscard]] std::optional<UnitSample> next_before(double time_s, const Excitation& excitation);

private:
  // Three channels, x, y and z, that differ in nothing but the axis.
  struct VectorQuantity {
    std::size_t first; // index of x
    const char* name;
    const char* quantity;
    const char* unit;
    const char* hierarchy;
    double range; // -range .. range
    double steps;
  };

  void describe_mpu9250();
  void describe_bma280();
  void describe_vector(const VectorQuantity& vector);
  void describe_temperature(double minimum, double maximum, double steps);
  void describe_adc(std::size_t index, const char* name);
  void measure_acceleration(UnitSample& sample, double time_s, const Excitation& excitation);
  void stamp_of_fifo(UnitSample& sample);
  void measure_rest(UnitSample& sample, double temperature_degc);
  void measure_adcs(UnitSample& sample, double time_s, const Excitation& excitation);
  [[nodiscard]] float quantised(double value, double step, double range) const;
  [[nodiscard]] const HarmonicGains& gains(std::size_t axis, double frequency_hz);
  [[nodiscard]] double felt(std::size_t axis, double time_s, const Excitation& excitation,
                            std::size_t line);

  SensorUnitSettings settings_;
  Random noise_;
  DauClock clock_;
  std::unique_ptr<SensorClock> sensor_clock_;
  StampFaults stamp_faults_;
  std::size_t fifo_place_ = 0;
  std::int64_t fifo_first_ns_ = 0;
  Random loss_;
  std::vector<ChannelDisturbance> sensor_disturbances_; // x, y, z
  ChannelDisturbance sync_disturbance_;
  std::vector<UnitChannel> channels_;
  double range_m_s2_ = 0.0;
  double step_m_s2_ = 0.0;
  double sync_range_v_ = 0.0;
  double noise_m_s2_ = 0.0; // standard deviation
  std::array<double, 3> offset_m_s2_{};
  std::array<std::map<double, HarmonicGains>, 3> gains_; // by frequency
  std::optional<SensorEdge> edge_;
  std::uint32_t sample_number_ = 0;
};

} // namespace dyncal::drivers::virtual_bench
