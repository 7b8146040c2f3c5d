#include "drivers/virtual_bench/model/trigger_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double noise_interval_s = 0.25e-6;
constexpr double two_pi = 2.0 * std::numbers::pi;

double fixed_delay(const TriggerSettings& settings) {
  Random random(settings.seed, "DSO output delay");
  return settings.output_delay_s + random.normal(settings.u_output_delay_s);
}

// Turns of the carrier since its last rising zero crossing, 0..1.
double turns_at(const Motion& motion) {
  const double turns = std::atan2(motion.sine, motion.cosine) / two_pi;
  return turns < 0.0 ? turns + 1.0 : turns;
}

} // namespace

double sync_line_v(const Excitation& excitation, double amplitude_v, double time_s) {
  const Motion motion = excitation.motion(time_s);
  if (!motion.sync_on) {
    return 0.0;
  }
  if (!excitation.drive().rectangle) {
    return amplitude_v * motion.sine;
  }
  // Trapezoid that crosses zero with the sine.
  const double from_zero_s =
      std::asin(std::clamp(motion.sine, -1.0, 1.0)) / (two_pi * motion.frequency_hz);
  return amplitude_v * std::clamp(from_zero_s / (0.5 * rectangle_rise_s), -1.0, 1.0);
}

TriggerModel::TriggerModel(const TriggerSettings& settings)
    : settings_(settings), noise_(settings.seed, "DSO trigger noise"),
      output_delay_s_(fixed_delay(settings)) {}

std::optional<double> TriggerModel::crossing(double zero_s, double level_v,
                                             const Excitation& excitation) {
  const double amplitude_v = settings_.sync_amplitude_v;
  if (std::abs(level_v) >= 0.9 * amplitude_v) {
    return std::nullopt;
  }
  const double angular_hz = two_pi * excitation.motion(zero_s).frequency_hz;
  if (excitation.drive().rectangle) {
    const double slope = amplitude_v / (0.5 * rectangle_rise_s);
    return zero_s + (level_v + noise_.normal(settings_.noise_v)) / slope;
  }
  const double level_s = std::asin(level_v / amplitude_v) / angular_hz;
  const double reach_s =
      std::asin(std::min(0.5, 6.0 * settings_.noise_v / amplitude_v)) / angular_hz;
  for (double offset_s = level_s - reach_s;; offset_s += noise_interval_s) {
    const double noise_v = noise_.normal(settings_.noise_v);
    const double end_v =
        amplitude_v * std::sin(angular_hz * (offset_s + noise_interval_s)) + noise_v;
    if (end_v < level_v) {
      continue;
    }
    const double begin_v = amplitude_v * std::sin(angular_hz * offset_s) + noise_v;
    const double part =
        begin_v >= level_v ? noise_.uniform() : (level_v - begin_v) / (end_v - begin_v);
    return zero_s + offset_s + part * noise_interval_s;
  }
}

std::optional<TriggerEvent> TriggerModel::first_between(double from_s, double until_s,
                                                        double level_v,
                                                        const Excitation& excitation) {
  const Motion motion = excitation.motion(from_s);
  if (!motion.sync_on || !excitation.drive().on) {
    return std::nullopt;
  }
  const double period_s = 1.0 / motion.frequency_hz;
  const double turns = turns_at(motion);
  // Ready in the quarter before the zero crossing; a crossing whose quarter has begun already has
  // to be passed over.
  const double zero_s = from_s + (turns > 0.85 ? 2.0 - turns : 1.0 - turns) * period_s;
  if (zero_s + 0.1 * period_s >= until_s) {
    return std::nullopt;
  }
  const auto trigger_s = crossing(zero_s, level_v, excitation);
  if (!trigger_s) {
    return std::nullopt;
  }
  return TriggerEvent{*trigger_s,
                      *trigger_s + output_delay_s_ + noise_.normal(settings_.output_jitter_s)};
}

} // namespace dyncal::drivers::virtual_bench
