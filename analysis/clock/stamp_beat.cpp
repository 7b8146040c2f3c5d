#include "analysis/clock/stamp_beat.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t min_samples = 64;
constexpr std::size_t intervals_for_median = 512;
constexpr double most_off_number = 0.3; // of a period: then an interval tells no number
// |E|^2 n / <e^2> is exponential with mean 1 for errors that scatter freely.
constexpr double significant_power = 11.5; // once in 10^5
// Intervals that tell a tick: of one period, with the ticks of the one stamp and of the other.
constexpr double longest_single = 1.75; // usual intervals
constexpr std::size_t most_values = 6;  // also with a latency of a tick or two
constexpr std::int64_t rounded_ns = 4;  // one value, of stamps that were rounded to whole ns
constexpr double least_tick = 1e-3;     // of the usual interval
constexpr double most_within = 1.5;     // ticks, of errors on the right line
// Of a line that leaves errors within a tick against that of least squares, and to 1e-4 of a tick.
constexpr double most_turn = 2.0; // ticks, from the middle to an end
constexpr int turns_tried = 25;

struct IntervalValue {
  std::int64_t min_ns = 0;
  std::int64_t max_ns = 0;
};

struct Ticks {
  double tick_ns = 0.0;   // 0: none, or it does not show
  bool are_alike = false; // all intervals of one period are
};

double usual_interval_ns(std::span<const std::int64_t> stamps_ns) {
  std::vector<double> intervals_ns;
  const std::size_t stride = 1 + stamps_ns.size() / intervals_for_median;
  for (std::size_t i = 1; i < stamps_ns.size(); i += stride) {
    intervals_ns.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  return upper_median(intervals_ns);
}

// Whether it is one of these values, or becomes one.
bool is_one_of(std::vector<IntervalValue>& values, std::int64_t interval_ns) {
  for (IntervalValue& value : values) {
    const std::int64_t min_ns = std::min(value.min_ns, interval_ns);
    const std::int64_t max_ns = std::max(value.max_ns, interval_ns);
    if (max_ns - min_ns <= rounded_ns) {
      value = {min_ns, max_ns};
      return true;
    }
  }
  values.push_back({interval_ns, interval_ns});
  return values.size() <= most_values;
}

// The usual case, which is looked at quickly.
bool are_all_alike(std::span<const std::int64_t> stamps_ns) {
  std::int64_t min_ns = stamps_ns[1] - stamps_ns[0], max_ns = min_ns;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    const std::int64_t interval_ns = stamps_ns[i] - stamps_ns[i - 1];
    min_ns = std::min(min_ns, interval_ns);
    max_ns = std::max(max_ns, interval_ns);
  }
  return max_ns - min_ns <= rounded_ns;
}

Ticks ticks_of(std::span<const std::int64_t> stamps_ns, double usual_ns) {
  if (are_all_alike(stamps_ns)) {
    return {0.0, true};
  }
  std::vector<IntervalValue> values;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    const std::int64_t interval_ns = stamps_ns[i] - stamps_ns[i - 1];
    if (static_cast<double>(interval_ns) < longest_single * usual_ns &&
        !is_one_of(values, interval_ns)) {
      return {};
    }
  }
  std::sort(values.begin(), values.end(),
            [](const auto& one, const auto& other) { return one.min_ns < other.min_ns; });
  double tick_ns = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i) {
    tick_ns = std::min(tick_ns, static_cast<double>(values[i].max_ns - values[i - 1].max_ns));
  }
  const bool is_worth_naming = std::isfinite(tick_ns) && tick_ns >= least_tick * usual_ns;
  return {is_worth_naming ? tick_ns : 0.0, values.size() == 1};
}

std::vector<double> numbers_in_order(std::size_t samples) {
  std::vector<double> numbers;
  numbers.reserve(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    numbers.push_back(static_cast<double>(i));
  }
  return numbers;
}

// From 0; empty where an interval tells none.
std::vector<double> numbers_by_intervals(std::span<const std::int64_t> stamps_ns, double period_ns,
                                         double tick_ns) {
  std::vector<double> numbers{0.0};
  numbers.reserve(stamps_ns.size());
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    const double periods = static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]) / period_ns;
    const double whole = std::max(tick_ns > 0.0 ? 1.0 : 0.0, std::round(periods));
    if (std::abs(periods - whole) > most_off_number + tick_ns / period_ns) {
      return {};
    }
    numbers.push_back(numbers.back() + whole);
  }
  return numbers;
}

// Distances from the line of least squares.
std::vector<double> errors_ns(std::span<const std::int64_t> stamps_ns,
                              std::span<const double> numbers) {
  const double n = static_cast<double>(numbers.size());
  double mean_number = 0.0, mean_ns = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    mean_number += numbers[i] / n;
    mean_ns += static_cast<double>(stamps_ns[i] - stamps_ns.front()) / n;
  }
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double x = numbers[i] - mean_number;
    squares += x * x;
    products += x * (static_cast<double>(stamps_ns[i] - stamps_ns.front()) - mean_ns);
  }
  std::vector<double> errors;
  errors.reserve(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    errors.push_back(static_cast<double>(stamps_ns[i] - stamps_ns.front()) - mean_ns -
                     products / squares * (numbers[i] - mean_number));
  }
  return errors;
}

struct ErrorsOfTicks {
  std::vector<double> numbers;
  std::vector<double> errors_ns; // from the line of least squares
};

// Empty where ticks alone do not explain the errors.
std::optional<ErrorsOfTicks> errors_of_ticks(std::span<const std::int64_t> stamps_ns,
                                             std::vector<double> numbers, double tick_ns) {
  if (numbers.empty()) {
    return std::nullopt;
  }
  ErrorsOfTicks found{std::move(numbers), {}};
  found.errors_ns = errors_ns(stamps_ns, found.numbers);
  const auto [min, max] = std::minmax_element(found.errors_ns.begin(), found.errors_ns.end());
  return *max - *min <= most_within * tick_ns ? std::optional(std::move(found)) : std::nullopt;
}

// In order where nothing is missing, else by the intervals.
std::optional<ErrorsOfTicks> errors_of_ticks(std::span<const std::int64_t> stamps_ns,
                                             double usual_ns, double tick_ns) {
  if (auto found = errors_of_ticks(stamps_ns, numbers_in_order(stamps_ns.size()), tick_ns)) {
    return found;
  }
  const auto coarse = numbers_by_intervals(stamps_ns, usual_ns, tick_ns);
  if (coarse.empty()) {
    return std::nullopt;
  }
  const double period_ns =
      static_cast<double>(stamps_ns.back() - stamps_ns.front()) / coarse.back();
  return errors_of_ticks(stamps_ns, numbers_by_intervals(stamps_ns, period_ns, tick_ns), tick_ns);
}

std::complex<double> twice_turned(const Frequency& frequency, std::int64_t since_first_ns) {
  return std::polar(1.0, -4.0 * std::numbers::pi * frequency.reduced_turns(since_first_ns));
}

// How high the lowest error may be, times `side`, from lines that turn about the middle: the best
// of a concave function.
double best_lowest_ns(const ErrorsOfTicks& ticked, double tick_ns, double side) {
  const double middle = 0.5 * ticked.numbers.back(), n = static_cast<double>(ticked.numbers.size());
  const double mean_number = std::accumulate(ticked.numbers.begin(), ticked.numbers.end(), 0.0) / n;
  const auto lowest_ns = [&](double slope_ns) {
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ticked.numbers.size(); ++i) {
      const double turned = slope_ns * (ticked.numbers[i] - mean_number);
      lowest = std::min(lowest, side * ticked.errors_ns[i] - turned);
    }
    return lowest;
  };
  double low_ns = -most_turn * tick_ns / middle, high_ns = -low_ns;
  for (int i = 0; i < turns_tried; ++i) {
    const double third_ns = (high_ns - low_ns) / 3.0;
    const bool is_higher = lowest_ns(low_ns + third_ns) < lowest_ns(high_ns - third_ns);
    (is_higher ? low_ns : high_ns) += is_higher ? third_ns : -third_ns;
  }
  return lowest_ns(0.5 * (low_ns + high_ns));
}

// Of lines from which all stamps are within half a tick: how far from the one of least squares
// they may be in the middle.
double largest_mean_ns(const ErrorsOfTicks& ticked, double tick_ns) {
  const double highest_ns = best_lowest_ns(ticked, tick_ns, 1.0) + 0.5 * tick_ns;
  const double lowest_ns = -best_lowest_ns(ticked, tick_ns, -1.0) - 0.5 * tick_ns;
  return lowest_ns < highest_ns ? std::max(std::abs(lowest_ns), std::abs(highest_ns))
                                : 0.5 * std::abs(lowest_ns + highest_ns);
}

StampBeat beat_of_ticks(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                        const ErrorsOfTicks& ticked, double tick_ns) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    sum += (std::polar(1.0, 1e-9 * frequency.angular() * ticked.errors_ns[i]) - 1.0) *
           twice_turned(frequency, stamps_ns[i] - stamps_ns.front());
  }
  return {std::abs(sum) / static_cast<double>(stamps_ns.size()),
          1e-9 * largest_mean_ns(ticked, tick_ns)};
}

StampBeat beat_of_scatter(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                          double usual_ns) {
  const auto numbers = numbers_by_intervals(stamps_ns, usual_ns, 0.0);
  if (numbers.empty()) {
    return {};
  }
  const auto errors = errors_ns(stamps_ns, numbers);
  std::complex<double> sum;
  double squares = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    sum += errors[i] * twice_turned(frequency, stamps_ns[i] - stamps_ns.front());
    squares += errors[i] * errors[i];
  }
  const bool is_real = std::norm(sum) > significant_power * squares;
  const double beat_s = 1e-9 * std::abs(sum) / static_cast<double>(errors.size());
  return {is_real ? frequency.angular() * beat_s : 0.0, 0.0};
}

} // namespace

StampBeat stamp_beat(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                     double stated_tick_s) {
  if (stamps_ns.size() < min_samples) {
    return {};
  }
  const double usual_ns = usual_interval_ns(stamps_ns);
  const Ticks ticks = ticks_of(stamps_ns, usual_ns);
  if (ticks.are_alike) {
    return {0.0, 1e9 * stated_tick_s >= least_tick * usual_ns ? 0.5 * stated_tick_s : 0.0};
  }
  if (ticks.tick_ns > 0.0) {
    if (const auto ticked = errors_of_ticks(stamps_ns, usual_ns, ticks.tick_ns)) {
      return beat_of_ticks(frequency, stamps_ns, *ticked, ticks.tick_ns);
    }
  }
  return beat_of_scatter(frequency, stamps_ns, usual_ns);
}

} // namespace dyncal::analysis
