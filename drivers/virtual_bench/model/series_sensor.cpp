#include "drivers/virtual_bench/model/series_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace dyncal::drivers::virtual_bench {

SeriesSensor::SeriesSensor(SeriesSensorSettings settings)
    : settings_(std::move(settings)), random_(settings_.seed, "TSS"),
      loss_(settings_.seed, "TSS loss"),
      disturbance_(settings_.seed, "sensor", settings_.faults, settings_.highest_level_m_s2) {}

SeriesSensorSettings series_sensor_of(const Preset& preset, std::uint64_t seed, double range_m_s2) {
  SeriesSensorSettings sensor;
  sensor.seed = seed;
  sensor.response = preset.axes[2];
  sensor.nominal_rate_hz = preset.nominal_rate_hz;
  sensor.rate_factor = 1.0 / (preset.mean_interval_s * preset.nominal_rate_hz);
  sensor.step_m_s2 = range_m_s2 / preset.counts_per_range;
  return sensor;
}

void SeriesSensor::trigger(double edge_s) {
  if (recording_) {
    return;
  }
  recording_ = true;
  ++shot_;
  counts_.clear();
  next_sample_ = 0;
  first_sample_s_ = edge_s;
  if (settings_.start.free_running) {
    first_sample_s_ += random_.uniform() / real_rate_hz();
  }
  if (settings_.start.jitter_s > 0.0) {
    first_sample_s_ += random_.normal(settings_.start.jitter_s);
  }
}

std::optional<RecordedSeries> SeriesSensor::advance_to(double time_s,
                                                       const Excitation& excitation) {
  if (!recording_) {
    return std::nullopt;
  }
  while (counts_.size() < settings_.samples) {
    const double at_s = first_sample_s_ + static_cast<double>(next_sample_) / real_rate_hz();
    if (at_s >= time_s) {
      return std::nullopt;
    }
    ++next_sample_;
    if (loss_.happens(settings_.loss)) {
      continue;
    }
    const Motion motion = excitation.motion(at_s - settings_.response.delay_s);
    const double value = disturbance_.cut(
        excitation.acceleration(motion, harmonic_gains(settings_.response, motion.frequency_hz)));
    const double counts = std::rint(
        (value + random_.normal(settings_.noise_m_s2) + disturbance_.added(at_s, motion)) /
        settings_.step_m_s2);
    counts_.push_back(
        static_cast<std::int16_t>(disturbance_.held(std::clamp(counts, -32768.0, 32767.0), at_s)));
  }
  recording_ = false;
  return RecordedSeries{shot_, std::exchange(counts_, {})};
}

std::string SeriesSensor::header_line(std::uint64_t shot) const {
  using Json = nlohmann::ordered_json;
  const Json channel = {{"name", "acceleration_z"},
                        {"quantity", "Acceleration"},
                        {"unit", "\\metre\\second\\tothe{-2}"},
                        {"minimum", -32768.0 * settings_.step_m_s2},
                        {"maximum", 32767.0 * settings_.step_m_s2},
                        {"scale", settings_.step_m_s2}};
  const Json line = {{"protocol", "dyncal-series"},
                     {"version", 1},
                     {"device", "virtual time series sensor"},
                     {"serial", std::to_string(settings_.seed)},
                     {"shot", shot},
                     {"nominal_rate_hz", settings_.nominal_rate_hz},
                     {"samples", settings_.samples},
                     {"values", "int16"},
                     {"channels", Json::array({channel})}};
  return line.dump();
}

std::string SeriesSensor::wire_form(const RecordedSeries& series) const {
  std::string bytes = header_line(series.shot) + "\n";
  const std::string length = std::to_string(2 * series.counts.size());
  bytes += "#" + std::to_string(length.size()) + length;
  for (const std::int16_t count : series.counts) {
    const auto bits = static_cast<std::uint16_t>(count);
    bytes.push_back(static_cast<char>(bits & 0xffU));
    bytes.push_back(static_cast<char>(bits >> 8U));
  }
  return bytes + "\n";
}

} // namespace dyncal::drivers::virtual_bench
