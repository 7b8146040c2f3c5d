#include "analysis/interferometer/reference_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "analysis/base/statistics.hpp"
#include "analysis/interferometer/decimation_filter.hpp"
#include "analysis/interferometer/rounded_text.hpp"

namespace dyncal::analysis {
namespace {

// Above 4, so that the third harmonic does not fold onto the excitation.
constexpr double wanted_rate_over_frequency = 4.2;
constexpr double smallest_rate_over_frequency = 4.0;
constexpr double largest_rate_over_frequency = 8.0;
constexpr std::size_t fewest_motion_values = 8;
constexpr double gap = 1.5; // intervals

std::size_t decimation_factor(double rate_over_frequency) {
  const double factor = std::max(1.0, std::floor(rate_over_frequency / wanted_rate_over_frequency));
  const bool still_too_fast = rate_over_frequency / factor > largest_rate_over_frequency;
  return static_cast<std::size_t>(factor) + (still_too_fast ? 1 : 0);
}

// Power of the decimated differences at a frequency in cycles per value, where the acceleration of
// the table is white: what folds onto it included. `integrations`: from acceleration to quantity.
double folded_power(const DecimationFilter& filter, double cycles, int integrations) {
  double sum = 0.0;
  for (const double folded : {cycles, 1.0 - cycles, 1.0 + cycles}) {
    const double gain = filter.gain(folded / static_cast<double>(filter.factor()));
    sum += gain * gain / std::pow(2.0 * std::numbers::pi * folded, 2 * integrations);
  }
  return sum * std::pow(2.0 * std::sin(std::numbers::pi * cycles), 4);
}

// The shape of the filter in cycles per value is nearly the same for every factor.
double noise_factor_of(std::size_t factor, double cycles, int integrations) {
  constexpr std::size_t largest_factor = 16;
  constexpr int frequencies = 100;
  const DecimationFilter filter(std::min(factor, largest_factor));
  double mean = 0.0;
  for (int i = 0; i < frequencies; ++i) {
    mean += folded_power(filter, (i + 0.5) / (2.0 * frequencies), integrations) / frequencies;
  }
  return std::max(1.0, std::sqrt(folded_power(filter, cycles, integrations) / mean));
}

// The usual distance of two stamps, by at most a thousand of them.
double usual_interval_ns(std::span<const std::int64_t> stamps_ns) {
  constexpr std::size_t enough = 1000;
  std::vector<double> intervals;
  const std::size_t stride = std::max<std::size_t>(1, (stamps_ns.size() - 1) / enough);
  for (std::size_t i = 1; i < stamps_ns.size(); i += stride) {
    intervals.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  return upper_median(intervals);
}

// Without a gap: first and last sample, one past the end.
struct Part {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<Part> parts_of(std::span<const std::int64_t> stamps_ns, double interval_ns) {
  std::vector<Part> parts{{0, 0}};
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    if (static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]) > gap * interval_ns) {
      parts.back().end = i;
      parts.push_back({i, 0});
    }
  }
  parts.back().end = stamps_ns.size();
  return parts;
}

// Stamps that were rounded, or jitter, do not change the mean distance within the parts.
double mean_interval_ns(std::span<const std::int64_t> stamps_ns, const std::vector<Part>& parts) {
  double sum_ns = 0.0;
  double intervals = 0.0;
  for (const Part& part : parts) {
    sum_ns += static_cast<double>(stamps_ns[part.end - 1] - stamps_ns[part.begin]);
    intervals += static_cast<double>(part.end - part.begin - 1);
  }
  return intervals > 0.0 ? sum_ns / intervals : 0.0;
}

void append_differences(std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                        std::size_t factor, double scale, StepMotion& motion) {
  DecimationFilter of_values(factor);
  DecimationFilter of_stamps(factor);
  std::vector<double> x;
  std::vector<double> since_first_ns;
  std::vector<double> stamps;
  for (const std::int64_t stamp_ns : stamps_ns) {
    stamps.push_back(static_cast<double>(stamp_ns - stamps_ns.front()));
  }
  of_values.push(values, x);
  of_stamps.push(stamps, since_first_ns);
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    motion.values.push_back(scale * ((x[i + 1] - x[i]) - (x[i] - x[i - 1])));
    motion.stamps_ns.push_back(stamps_ns.front() + std::llround(since_first_ns[i]));
  }
}

Expected<double> rate_over_frequency(double rate_hz, double frequency_hz) {
  if (!(rate_hz >= smallest_rate_over_frequency * frequency_hz) || !std::isfinite(rate_hz)) {
    return fail(ErrorCode::frequency_out_of_range,
                "displacement or velocity are sampled at " + rounded_text(rate_hz, 6) + " Hz; " +
                    rounded_text(frequency_hz, 6) + " Hz needs four times its frequency at least");
  }
  return rate_hz / frequency_hz;
}

// Means over 2 half + 1 values about each; near the ends on the line through the first or last two
// of them that are a period apart.
void subtract_means(std::span<double> values, std::size_t half) {
  const std::size_t n = values.size();
  const std::size_t length = 2 * half + 1;
  if (n < 2 * length) {
    double sum = 0.0;
    for (const double value : values) {
      sum += value / static_cast<double>(n);
    }
    for (double& value : values) {
      value -= sum;
    }
    return;
  }
  std::vector<double> means;
  double sum = 0.0; // about the first value, so that no digit is lost
  const double first = values.front();
  for (std::size_t i = 0; i < n; ++i) {
    sum += values[i] - first;
    if (i + 1 >= length) {
      means.push_back(first + sum / static_cast<double>(length));
      sum -= values[i + 1 - length] - first;
    }
  }
  const auto slope = [&](std::size_t from) {
    return (means[from + length - 1] - means[from]) / static_cast<double>(length - 1);
  };
  const double first_slope = slope(0);
  const double last_slope = slope(means.size() - length);
  for (std::size_t i = 0; i < n; ++i) {
    if (i < half) {
      values[i] -= means.front() - first_slope * static_cast<double>(half - i);
    } else if (i - half < means.size()) {
      values[i] -= means[i - half];
    } else {
      values[i] -= means.back() + last_slope * static_cast<double>(i - half - means.size() + 1);
    }
  }
}

} // namespace

std::vector<double> without_slow_motion(double frequency_hz,
                                        std::span<const std::int64_t> stamps_ns,
                                        std::span<const double> values) {
  std::vector<double> result(values.begin(), values.end());
  if (values.size() < 2) {
    return result;
  }
  const std::vector<Part> parts = parts_of(stamps_ns, usual_interval_ns(stamps_ns));
  const double interval_ns = std::max(1.0, mean_interval_ns(stamps_ns, parts));
  const double samples_a_period = std::min(1e9 / frequency_hz / interval_ns, 1e9);
  const auto half =
      static_cast<std::size_t>(std::llround(std::max(0.0, samples_a_period - 1.0) / 2.0));
  for (const Part& part : parts) {
    subtract_means(std::span(result).subspan(part.begin, part.end - part.begin),
                   std::max<std::size_t>(1, half));
  }
  return result;
}

CentredSamples centred_samples(double frequency_hz, std::span<const std::int64_t> stamps_ns,
                               std::span<const double> values) {
  CentredSamples centred;
  if (stamps_ns.size() < 2) {
    return centred;
  }
  const auto half_ns = static_cast<std::int64_t>(0.5e9 / frequency_hz);
  for (const Part& part : parts_of(stamps_ns, usual_interval_ns(stamps_ns))) {
    for (std::size_t i = part.begin; i < part.end; ++i) {
      if (stamps_ns[i] - stamps_ns[part.begin] > half_ns &&
          stamps_ns[part.end - 1] - stamps_ns[i] > half_ns) {
        centred.stamps_ns.push_back(stamps_ns[i]);
        centred.values.push_back(values[i]);
      }
    }
  }
  return centred;
}

std::string_view to_string(MotionQuantity quantity) {
  switch (quantity) {
  case MotionQuantity::velocity:
    return "velocity";
  case MotionQuantity::displacement:
    return "displacement";
  default:
    return "acceleration";
  }
}

std::complex<double> motion_factor(MotionQuantity from, MotionQuantity to, double angular_hz) {
  constexpr std::complex<double> i{0.0, 1.0};
  switch (static_cast<int>(from) - static_cast<int>(to)) { // times to differentiate
  case 2:
    return -angular_hz * angular_hz;
  case 1:
    return i * angular_hz;
  case -1:
    return -i / angular_hz;
  case -2:
    return -1.0 / (angular_hz * angular_hz);
  default:
    return 1.0;
  }
}

Expected<StepMotion> motion_of_step(MotionQuantity quantity, const Frequency& frequency,
                                    std::span<const std::int64_t> stamps_ns,
                                    std::span<const double> values) {
  if (stamps_ns.size() != values.size() ||
      std::ranges::adjacent_find(stamps_ns, std::greater_equal{}) != stamps_ns.end()) {
    return fail(ErrorCode::invalid_argument,
                "displacement or velocity need a stamp for every sample, and later ones for later "
                "samples");
  }
  if (stamps_ns.size() < fewest_motion_values) {
    return fail(ErrorCode::too_few_samples, "there are " + std::to_string(stamps_ns.size()) +
                                                " samples of displacement or velocity");
  }
  const std::vector<Part> parts = parts_of(stamps_ns, usual_interval_ns(stamps_ns));
  const double rate_hz = 1e9 / mean_interval_ns(stamps_ns, parts);
  DYNCAL_TRY(const double ratio, rate_over_frequency(rate_hz, frequency.hz()));
  const DecimationFilter filter(decimation_factor(ratio));
  const std::size_t factor = filter.factor();
  const double half_difference =
      std::sin(std::numbers::pi * static_cast<double>(factor) / ratio); // at f
  const double gain = filter.gain(1.0 / ratio) * -4.0 * half_difference * half_difference;
  StepMotion motion;
  for (const Part& part : parts) {
    append_differences(stamps_ns.subspan(part.begin, part.end - part.begin),
                       values.subspan(part.begin, part.end - part.begin), factor, 1.0 / gain,
                       motion);
  }
  motion.rate_hz = rate_hz / static_cast<double>(factor);
  if (motion.values.size() < fewest_motion_values) {
    return fail(ErrorCode::too_few_samples,
                "the record of displacement or velocity is too short, or has too many gaps: after "
                "decimation to " +
                    rounded_text(motion.rate_hz, 6) + " Hz " +
                    std::to_string(motion.values.size()) +
                    " values are left. Record ten periods at least");
  }
  motion.noise_factor =
      noise_factor_of(factor, static_cast<double>(factor) / ratio, static_cast<int>(quantity));
  return motion;
}

} // namespace dyncal::analysis
