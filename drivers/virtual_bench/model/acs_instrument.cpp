#include "drivers/virtual_bench/model/acs_instrument.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double counts_per_range = 8388608.0; // 24 bit
constexpr double usual_sync_range_v = 10.0;
constexpr double reference_noise_m_s2 = 0.004;
constexpr double sync_noise_v = 60e-6;
constexpr double hum_hz = 49.98; // the mains are rarely exactly at 50 Hz
constexpr double reference_hum_m_s2 = 1.5e-3;
constexpr double pulse_range_v = 5.0;
constexpr double pulse_height_v = 3.3;
constexpr double pulse_width_s = 0.1;
constexpr double samples_of_edge = 6.0;
constexpr double sync_hum_v = 150e-6;

std::int32_t to_counts(double value, double scale) {
  return static_cast<std::int32_t>(
      std::clamp(std::rint(value / scale), -counts_per_range, counts_per_range - 1.0));
}

} // namespace

AcsInstrument::AcsInstrument(const AcsSettings& settings)
    : settings_(settings), noise_(settings.seed, "ACS noise"), loss_(settings.seed, "ACS loss"),
      reference_disturbance_(settings.seed, "reference", settings.reference_faults,
                             settings.highest_level_m_s2),
      sync_disturbance_(settings.seed, "sync", settings.sync_faults, settings.sync_amplitude_v) {
  Random draws(settings.seed, "ACS errors");
  rate_error_ = draws.uniform(-settings.max_rate_error, settings.max_rate_error);
  if (settings.utc) {
    rate_error_ = 0.0;
  }
  gain_error_ = draws.normal(settings.reference_magnitude_rel);
  phase_error_rad_ = draws.normal(settings.reference_phase_rad);
  hum_phase_rad_ = draws.uniform(0.0, 2.0 * std::numbers::pi);
  const double reference_range_m_s2 =
      settings.reference_faults.range > 0.0
          ? settings.reference_faults.range
          : 50.0 * std::ceil(1.3 * settings.highest_level_m_s2 / 50.0);
  const double sync_range_v =
      settings.sync_faults.range > 0.0 ? settings.sync_faults.range : usual_sync_range_v;
  reference_scale_ = reference_range_m_s2 / counts_per_range;
  sync_scale_ = sync_range_v / counts_per_range;
  channels_ = {{"reference", "Acceleration", "\\metre\\second\\tothe{-2}", reference_range_m_s2,
                reference_scale_},
               {"sync", "Voltage", "\\volt", sync_range_v, sync_scale_}};
  if (settings.pulses_utc_origin_ns) {
    channels_.push_back(
        {"pps", "Voltage", "\\volt", pulse_range_v, pulse_range_v / counts_per_range});
  }
  reference_gains_ = {std::polar(1.0 + gain_error_, phase_error_rad_), 1.0 + gain_error_,
                      1.0 + gain_error_};
  if (settings.interferometer) {
    InterferometerSettings interferometer = *settings.interferometer;
    interferometer.spot = std::polar(1.0 + gain_error_, phase_error_rad_);
    interferometer_.emplace(interferometer, settings.seed, interval_s(),
                            SyncLevel{settings.sync_amplitude_v, settings.sync_is_first_output});
    channels_ = Interferometer::channels();
  }
}

double AcsInstrument::interval_s() const {
  return (1.0 + rate_error_) / static_cast<double>(settings_.rate_hz);
}

double AcsInstrument::sync_amplitude_v(const Motion& motion) const {
  return settings_.sync_is_first_output ? motion.generator_v
         : motion.sync_on               ? settings_.sync_amplitude_v * motion.sync_part
                                        : 0.0;
}

// Edges as a filter of no delay makes them, whose response is a raised cosine.
double AcsInstrument::pulse_v(double at_s) const {
  const double origin_s =
      static_cast<double>(*settings_.pulses_utc_origin_ns % 1'000'000'000) / 1e9;
  const double since_second_s = origin_s + at_s - std::floor(origin_s + at_s);
  const auto edge = [width_s = samples_of_edge * interval_s()](double after_s) {
    const double part = std::clamp(after_s / width_s + 0.5, 0.0, 1.0);
    return part - std::sin(2.0 * std::numbers::pi * part) / (2.0 * std::numbers::pi);
  };
  return pulse_height_v * (edge(since_second_s) - edge(since_second_s - pulse_width_s) +
                           edge(since_second_s - 1.0)); // of the next second
}

void AcsInstrument::sample_until(double time_s, const Excitation& excitation, AcsSamples& samples) {
  samples.channels = channels_.size();
  if (samples.counts.empty()) {
    samples.first_sample = next_sample_;
  }
  if (interferometer_) {
    const std::uint64_t from = next_sample_;
    while (static_cast<double>(next_sample_) * interval_s() < time_s) {
      ++next_sample_;
    }
    interferometer_->sample(from, next_sample_, excitation, samples.counts);
  } else {
    sample_reference_until(time_s, excitation, samples);
  }
}

void AcsInstrument::sample_reference_until(double time_s, const Excitation& excitation,
                                           AcsSamples& samples) {
  const double interval_s = this->interval_s();
  for (double at_s = static_cast<double>(next_sample_) * interval_s; at_s < time_s;
       at_s = static_cast<double>(++next_sample_) * interval_s) {
    const Motion motion = excitation.motion(at_s);
    double acceleration = 0.0;
    double sync_sine_v = 0.0;
    for (std::size_t line = 0; line < excitation.lines(); ++line) {
      const Motion one = line == 0 ? motion : excitation.motion(at_s, line);
      acceleration += excitation.acceleration(one, reference_gains_);
      sync_sine_v += sync_amplitude_v(one) * one.sine;
    }
    const double hum = std::sin(2.0 * std::numbers::pi * hum_hz * at_s + hum_phase_rad_);
    const double reference = reference_disturbance_.cut(acceleration) + reference_hum_m_s2 * hum +
                             noise_.normal(reference_noise_m_s2) +
                             reference_disturbance_.added(at_s, motion);
    const double sync = sync_sine_v + sync_hum_v * hum + noise_.normal(sync_noise_v) +
                        sync_disturbance_.added(at_s, motion);
    samples.counts.push_back(static_cast<std::int32_t>(
        reference_disturbance_.held(to_counts(reference, reference_scale_), at_s)));
    samples.counts.push_back(
        static_cast<std::int32_t>(sync_disturbance_.held(to_counts(sync, sync_scale_), at_s)));
    if (settings_.pulses_utc_origin_ns) {
      const double noise_v = noise_.normal(sync_noise_v);
      samples.counts.push_back(
          to_counts(pulse_v(at_s) + noise_v, pulse_range_v / counts_per_range));
    }
  }
}

bool AcsInstrument::sends(AcsSamples& samples) {
  samples.first_sample -= uncounted_;
  const bool lost = loss_.happens(settings_.loss.probability);
  if (lost && !settings_.loss.counted) {
    uncounted_ += samples.samples();
  }
  return !lost;
}

std::int64_t AcsInstrument::stamp_ns(std::uint64_t sample) const {
  // Whole seconds first: the product of a long record would not fit into 64 bits.
  const auto rate = static_cast<std::uint64_t>(settings_.rate_hz);
  const std::uint64_t rest_ns = ((sample % rate) * 2'000'000'000U + rate) / (2 * rate);
  return settings_.origin_ns + static_cast<std::int64_t>(sample / rate * 1'000'000'000U + rest_ns);
}

std::string AcsInstrument::description_line() const {
  using Json = nlohmann::ordered_json;
  Json channels = Json::array();
  for (const AcsChannel& channel : channels_) {
    channels.push_back({{"name", channel.name},
                        {"quantity", channel.quantity},
                        {"unit", channel.unit},
                        {"minimum", -channel.range},
                        {"maximum", channel.range},
                        {"scale", channel.scale}});
  }
  const Json line = {{"protocol", "dyncal-acs-stream"},
                     {"version", 1},
                     {"device", "virtual analogue calibration system"},
                     {"serial", std::to_string(settings_.seed)},
                     {"sample_rate_hz", {{"numerator", settings_.rate_hz}, {"denominator", 1}}},
                     {"origin_ns", settings_.origin_ns},
                     {"time_base", settings_.utc ? "utc" : "local"},
                     {"values", "int32"},
                     {"channels", channels}};
  return line.dump();
}

} // namespace dyncal::drivers::virtual_bench
