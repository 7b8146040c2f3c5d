#include "analysis/step/compound_integrity.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t least_clipped = 3;
constexpr double standard_errors = 4.0;
constexpr std::size_t least_stuck = 4;
constexpr double steps_of_stuck = 2.0;
constexpr double noise_of_stuck = 6.0;
constexpr double part_of_stuck = 0.02;

struct Signal {
  std::span<const double> values;
  std::span<const double> rest;
  double level = 0.0; // mean of what is left: the offset
  double noise = 0.0;
  double power = 0.0; // sum of the squares of the lines

  Signal(std::span<const double> all, std::span<const double> left)
      : values(all), rest(left), level(mean(left)), noise(standard_deviation(left)) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      power += lines_at(i) * lines_at(i);
    }
  }
  // Their sum, about the offset.
  [[nodiscard]] double lines_at(std::size_t i) const { return values[i] - rest[i]; }
  // By how much they go on beyond the value, upwards for +1.
  [[nodiscard]] double beyond(std::size_t i, double sign) const {
    return -sign * (rest[i] - level);
  }
};

void look_at_extreme(const Signal& signal, double extreme, double sign, double resolution,
                     SignalIntegrity& integrity) {
  std::size_t count = 0;
  double beyond = 0.0;
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    if (signal.values[i] == extreme) {
      ++count;
      beyond += signal.beyond(i, sign);
    }
  }
  const double standard_error = signal.noise / std::sqrt(static_cast<double>(count));
  if (count >= least_clipped && beyond / static_cast<double>(count) >
                                    std::max(resolution, standard_errors * standard_error)) {
    integrity.clipped_part +=
        static_cast<double>(count) / static_cast<double>(signal.values.size());
  }
}

void look_for_stuck(const Signal& signal, double resolution, SignalIntegrity& integrity) {
  const auto n = static_cast<double>(signal.values.size());
  const double least = std::max({steps_of_stuck * resolution, noise_of_stuck * signal.noise,
                                 part_of_stuck * std::sqrt(signal.power / n)});
  std::size_t stuck = 0;
  for (std::size_t begin = 0, end = 0; begin < signal.values.size(); begin = end) {
    double low = signal.lines_at(begin);
    double high = low;
    for (end = begin + 1; end < signal.values.size() && signal.values[end] == signal.values[begin];
         ++end) {
      low = std::min(low, signal.lines_at(end));
      high = std::max(high, signal.lines_at(end));
    }
    integrity.longest_run = std::max<std::uint64_t>(integrity.longest_run, end - begin);
    if (end - begin >= least_stuck && high - low > least) {
      integrity.longest_stuck = std::max<std::uint64_t>(integrity.longest_stuck, end - begin);
      stuck += end - begin;
    }
  }
  integrity.stuck_part = static_cast<double>(stuck) / n;
}

} // namespace

void measure_compound_integrity(std::span<const double> values, std::span<const double> rest,
                                const SignalExpectation& expected, SignalIntegrity& integrity) {
  const Signal signal(values, rest);
  const auto [low, high] = std::ranges::minmax(values);
  const double half = 0.5 * expected.resolution;
  const auto at_range = std::ranges::count_if(values, [&](double value) {
    return value <= expected.range_low + half || value >= expected.range_high - half;
  });
  integrity.at_range_part = static_cast<double>(at_range) / static_cast<double>(values.size());
  integrity.clipped_part = 0.0;
  look_at_extreme(signal, high, 1.0, expected.resolution, integrity);
  look_at_extreme(signal, low, -1.0, expected.resolution, integrity);
  integrity.at_range_part = std::max(integrity.at_range_part, integrity.clipped_part);
  integrity.clipping_rel = integrity.at_range_part;
  integrity.longest_run = 0;
  integrity.longest_stuck = 0;
  look_for_stuck(signal, expected.resolution, integrity);
}

} // namespace dyncal::analysis
