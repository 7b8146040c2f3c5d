#include "drivers/virtual_bench/model/sensor_unit.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double standard_gravity = 9.80665;
constexpr double adc_range_v = 10.0;
constexpr double adc_step_v = 2.0 * adc_range_v / 4096.0;
constexpr double gyroscope_range_rad_s = 4.363323129985824; // 250 degrees per second
constexpr double gyroscope_noise_rad_s = 3.9e-3;            // 0.01 degrees/s/sqrt(Hz)
constexpr double magnetometer_range_ut = 4912.0;
constexpr double magnetometer_noise_ut = 0.4;
constexpr std::array<double, 3> earth_field_ut{18.6, 1.4, -45.1};
constexpr double steps_16_bit = 65536.0;

// The smallest range that holds the excitation with gravity and a tenth to spare.
double choose_range_g(const SensorUnitSettings& settings) {
  const double shown_m_s2 = settings.highest_level_m_s2 * settings.largest_magnitude;
  double range_g = 2.0;
  while (range_g < settings.widest_range_g &&
         1.1 * shown_m_s2 + standard_gravity > range_g * standard_gravity) {
    range_g *= 2.0;
  }
  return range_g;
}

} // namespace

SensorUnit::SensorUnit(const SensorUnitSettings& settings)
    : settings_(settings), noise_(settings.seed, "sensor noise"),
      clock_(settings.seed, settings.start_ns),
      sensor_clock_(
          make_sensor_clock(settings.preset.sensor, settings.seed, settings.thermal_cycle_s)),
      stamp_faults_(settings.seed, settings.stamp_faults), loss_(settings.seed, "sensor loss"),
      sensor_disturbances_(3, ChannelDisturbance(settings.seed, "sensor", settings.sensor_faults,
                                                 settings.highest_level_m_s2)),
      sync_disturbance_(settings.seed, "sync at the unit", settings.sync_faults,
                        settings.sync_amplitude_v) {
  const Preset& preset = settings_.preset;
  range_m_s2_ = settings.sensor_faults.range > 0.0 ? settings.sensor_faults.range
                                                   : choose_range_g(settings) * standard_gravity;
  sync_range_v_ = settings.sync_faults.range > 0.0 ? settings.sync_faults.range : adc_range_v;
  step_m_s2_ = range_m_s2_ / preset.counts_per_range;
  noise_m_s2_ =
      preset.noise_g_per_root_hz * standard_gravity * std::sqrt(0.5 / preset.mean_interval_s);
  Random offsets(settings.seed, "sensor offsets");
  for (double& offset : offset_m_s2_) {
    offset = offsets.normal(0.25);
  }
  offset_m_s2_[2] += standard_gravity; // z points upwards
  if (preset.sensor == SensorKind::mpu9250) {
    describe_mpu9250();
  } else {
    describe_bma280();
  }
  describe_adc(10, "sync");
  describe_adc(11, "adc_2");
  describe_adc(12, "adc_3");
}

void SensorUnit::describe_adc(std::size_t index, const char* name) {
  channels_.push_back({.index = index,
                       .name = name,
                       .quantity = "Voltage",
                       .unit = "\\volt",
                       .hierarchy = "Voltage/" + std::to_string(index - 10),
                       .minimum = -adc_range_v,
                       .maximum = adc_range_v,
                       .steps = 4096.0,
                       .declared = false});
}

void SensorUnit::describe_vector(const VectorQuantity& vector) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string small(1, "xyz"[axis]);
    const std::string capital(1, "XYZ"[axis]);
    channels_.push_back({.index = vector.first + axis,
                         .name = std::string(vector.name) + "_" + small,
                         .quantity = capital + " " + vector.quantity,
                         .unit = vector.unit,
                         .hierarchy = std::string(vector.hierarchy) + "/" + std::to_string(axis),
                         .minimum = -vector.range,
                         .maximum = vector.range,
                         .steps = vector.steps});
  }
}

void SensorUnit::describe_temperature(double minimum, double maximum, double steps) {
  channels_.push_back({.index = 9,
                       .name = "temperature",
                       .quantity = "Temperature",
                       .unit = "\\degreecelsius",
                       .hierarchy = "Temperature/0",
                       .minimum = minimum,
                       .maximum = maximum,
                       .steps = steps});
}

void SensorUnit::describe_mpu9250() {
  describe_vector({0, "acceleration", "Acceleration", "\\metre\\second\\tothe{-2}", "Acceleration",
                   range_m_s2_, steps_16_bit});
  describe_vector({3, "angular_velocity", "Angular velocity", "\\radian\\second\\tothe{-1}",
                   "Angular_velocity", gyroscope_range_rad_s, steps_16_bit});
  describe_vector({6, "magnetic_flux_density", "Magnetic flux density", "\\micro\\tesla",
                   "Magnetic_flux_density", magnetometer_range_ut, steps_16_bit});
  describe_temperature(-77.14, 119.15, steps_16_bit);
}

void SensorUnit::describe_bma280() {
  describe_vector({0, "acceleration", "Acceleration", "\\metre\\second\\tothe{-2}", "Acceleration",
                   range_m_s2_, 16384.0});
  describe_temperature(-41.0, 87.0, 256.0);
}

float SensorUnit::quantised(double value, double step, double range) const {
  const double counts =
      std::clamp(std::rint(value / step), -std::rint(range / step), std::rint(range / step) - 1.0);
  return static_cast<float>(counts * step + 0.0); // no negative zero
}

const HarmonicGains& SensorUnit::gains(std::size_t axis, double frequency_hz) {
  const auto [known, is_new] = gains_[axis].try_emplace(frequency_hz);
  if (is_new) {
    known->second = harmonic_gains(settings_.preset.axes[axis], frequency_hz);
  }
  return known->second;
}

// Of one line, as this axis feels it.
double SensorUnit::felt(std::size_t axis, double time_s, const Excitation& excitation,
                        std::size_t line) {
  Motion motion = excitation.motion(time_s - settings_.preset.axes[axis].delay_s, line);
  const DelayChange& change = settings_.delay_change;
  if (change.by_s != 0.0 && motion.since_change_s > change.after_s) {
    motion = excitation.motion(time_s - settings_.preset.axes[axis].delay_s - change.by_s, line);
  }
  return excitation.acceleration(motion, gains(axis, motion.frequency_hz));
}

void SensorUnit::measure_acceleration(UnitSample& sample, double time_s,
                                      const Excitation& excitation) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double acceleration = 0.0;
    for (std::size_t line = 0; line < excitation.lines(); ++line) {
      acceleration += felt(axis, time_s, excitation, line);
    }
    const Motion motion = excitation.motion(time_s - settings_.preset.axes[axis].delay_s);
    const double value = sensor_disturbances_[axis].cut(acceleration) + offset_m_s2_[axis] +
                         noise_.normal(noise_m_s2_) +
                         sensor_disturbances_[axis].added(time_s, motion);
    sample.data[axis] = static_cast<float>(
        sensor_disturbances_[axis].held(quantised(value, step_m_s2_, range_m_s2_), time_s));
  }
}

void SensorUnit::measure_rest(UnitSample& sample, double temperature_degc) {
  if (settings_.preset.sensor == SensorKind::bma280) {
    sample.data[9] = quantised(temperature_degc - 23.0 + noise_.normal(0.1), 0.5, 64.0) + 23.0F;
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sample.data[3 + axis] = quantised(noise_.normal(gyroscope_noise_rad_s),
                                      gyroscope_range_rad_s / 32768.0, gyroscope_range_rad_s);
    sample.data[6 + axis] = quantised(earth_field_ut[axis] + noise_.normal(magnetometer_noise_ut),
                                      magnetometer_range_ut / 32768.0, magnetometer_range_ut);
  }
  sample.data[9] =
      quantised(temperature_degc - 21.0 + noise_.normal(0.01), 1.0 / 333.87, 98.0) + 21.0F;
}

void SensorUnit::measure_adcs(UnitSample& sample, double time_s, const Excitation& excitation) {
  const Motion motion = excitation.motion(time_s - settings_.adc.lag_s);
  double sync_v = 0.0;
  for (std::size_t line = 0; line < excitation.lines(); ++line) {
    const Motion one = line == 0 ? motion : excitation.motion(time_s - settings_.adc.lag_s, line);
    const double amplitude_v = settings_.sync_is_first_output ? one.generator_v
                               : one.sync_on ? settings_.sync_amplitude_v * one.sync_part
                                             : 0.0;
    sync_v += amplitude_v * one.sine;
  }
  for (std::size_t adc = 0; adc < 3; ++adc) {
    const bool is_sync = adc == 0;
    const double input_v = (is_sync ? sync_v + sync_disturbance_.added(time_s, motion) : 0.0) +
                           noise_.normal(adc_step_v);
    const double shown_v = quantised(input_v, adc_step_v, is_sync ? sync_range_v_ : adc_range_v);
    sample.data[10 + adc] = static_cast<float>(
        settings_.adc.gain * (is_sync ? sync_disturbance_.held(shown_v, time_s) : shown_v));
  }
}

// A buffer that is read as a whole: its samples have the stamp of the reading, 10 ns apart.
void SensorUnit::stamp_of_fifo(UnitSample& sample) {
  if (settings_.fifo_samples < 2) {
    return;
  }
  const auto place = static_cast<std::int64_t>(fifo_place_);
  if (place == 0) {
    fifo_first_ns_ = sample.utc_ns;
  }
  sample.utc_ns = fifo_first_ns_ + 10 * place;
  fifo_place_ = (fifo_place_ + 1) % settings_.fifo_samples;
}

std::optional<UnitSample> SensorUnit::next_before(double time_s, const Excitation& excitation) {
  for (;;) {
    if (!edge_) {
      edge_ = sensor_clock_->next();
    }
    if (edge_->time_s >= time_s) {
      return std::nullopt;
    }
    const SensorEdge edge = *edge_;
    edge_.reset();
    if (loss_.happens(settings_.loss.probability)) {
      sample_number_ += settings_.loss.counted ? 1 : 0;
      continue;
    }
    const DauStamp stamp = clock_.stamp(edge.time_s);
    UnitSample sample;
    sample.sample_number = ++sample_number_;
    sample.utc_ns = stamp.utc_ns;
    sample.uncertainty_ns = stamp.uncertainty_ns;
    sample.ticks = stamp.ticks;
    stamp_of_fifo(sample);
    measure_acceleration(sample, edge.time_s, excitation);
    measure_rest(sample, edge.temperature_degc);
    measure_adcs(sample, edge.time_s, excitation);
    if (stamp_faults_.apply(sample)) {
      return sample;
    }
  }
}

} // namespace dyncal::drivers::virtual_bench
