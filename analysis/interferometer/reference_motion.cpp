#include "analysis/interferometer/reference_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "analysis/interferometer/rounded_text.hpp"

namespace dyncal::analysis {
namespace {

// Above 4, so that the third harmonic does not fold onto the excitation.
constexpr double wanted_rate_over_frequency = 4.2;
constexpr double smallest_rate_over_frequency = 4.0;
constexpr double largest_rate_over_frequency = 8.0;
constexpr std::size_t fewest_motion_values = 8;

std::size_t decimation_factor(double rate_over_frequency) {
  const double factor = std::max(1.0, std::floor(rate_over_frequency / wanted_rate_over_frequency));
  const bool still_too_fast = rate_over_frequency / factor > largest_rate_over_frequency;
  return static_cast<std::size_t>(factor) + (still_too_fast ? 1 : 0);
}

// Power of the decimated acceleration at a frequency in cycles per value, where that of the table
// is white: what folds onto it included.
double folded_power(const DecimationFilter& filter, double cycles) {
  double sum = 0.0;
  for (const double folded : {cycles, 1.0 - cycles, 1.0 + cycles}) {
    const double gain = filter.gain(folded / static_cast<double>(filter.factor()));
    sum += gain * gain / std::pow(2.0 * std::numbers::pi * folded, 4);
  }
  return sum * std::pow(2.0 * std::sin(std::numbers::pi * cycles), 4);
}

// The shape of the filter in cycles per value is nearly the same for every factor.
double noise_factor_of(std::size_t factor, double cycles) {
  constexpr std::size_t largest_factor = 16;
  constexpr int frequencies = 100;
  const DecimationFilter filter(std::min(factor, largest_factor));
  double mean = 0.0;
  for (int i = 0; i < frequencies; ++i) {
    mean += folded_power(filter, (i + 0.5) / (2.0 * frequencies)) / frequencies;
  }
  return std::max(1.0, std::sqrt(folded_power(filter, cycles) / mean));
}

} // namespace

Expected<ReferenceMotion> ReferenceMotion::of_step(const MotionSettings& settings) {
  if (!(settings.frequency_hz > 0.0) || !std::isfinite(settings.sample_rate_hz) ||
      settings.displacement_per_turn_m == 0.0 || !std::isfinite(settings.displacement_per_turn_m)) {
    return fail(ErrorCode::invalid_argument,
                "frequency, sample rate and wavelength of an interferometer must be given");
  }
  const double ratio = settings.sample_rate_hz / settings.frequency_hz;
  if (!(ratio >= smallest_rate_over_frequency)) {
    return fail(ErrorCode::frequency_out_of_range,
                "the interferometer is sampled at " + rounded_text(settings.sample_rate_hz, 6) +
                    " Hz; " + rounded_text(settings.frequency_hz, 6) +
                    " Hz needs four times its frequency at least");
  }
  return ReferenceMotion(settings, decimation_factor(ratio));
}

double ReferenceMotion::decimated_rate_hz() const {
  return settings_.sample_rate_hz / static_cast<double>(turns_filter_.factor());
}

Expected<DecimatedMotion> ReferenceMotion::decimated() const {
  const std::size_t values = std::min(turns_.size(), sync_.size());
  if (values < fewest_motion_values + 2) {
    return fail(ErrorCode::too_few_samples,
                "the record of the interferometer is too short: after decimation to " +
                    rounded_text(decimated_rate_hz(), 6) + " Hz " + std::to_string(values) +
                    " values are left. Record ten periods at least");
  }
  const double rate_hz = decimated_rate_hz();
  const double gain = turns_filter_.gain(settings_.frequency_hz / settings_.sample_rate_hz);
  const double half_angle = std::numbers::pi * settings_.frequency_hz / rate_hz;
  // The second difference is fd^2 at low frequencies; here it is less by (sin x / x)^2.
  const double fall = std::sin(half_angle) / half_angle;
  const double scale = settings_.displacement_per_turn_m * rate_hz * rate_hz / (gain * fall * fall);
  DecimatedMotion motion;
  motion.interval_s = 1.0 / rate_hz;
  motion.first_s = static_cast<double>(turns_filter_.first_sample() + turns_filter_.factor()) /
                   settings_.sample_rate_hz;
  motion.noise_factor = noise_factor_of(turns_filter_.factor(), settings_.frequency_hz / rate_hz);
  motion.acceleration_m_s2.reserve(values - 2);
  motion.sync.reserve(values - 2);
  for (std::size_t i = 1; i + 1 < values; ++i) {
    const double difference = (turns_[i + 1] - turns_[i]) - (turns_[i] - turns_[i - 1]);
    motion.acceleration_m_s2.push_back(difference * scale);
    motion.sync.push_back(sync_[i] / gain);
  }
  return motion;
}

} // namespace dyncal::analysis
