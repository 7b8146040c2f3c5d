#include "analysis/clock/clock_steps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t max_looked_at = 256;
constexpr std::size_t min_samples = 16;
// Of normal scatter one interval in 1e32 lies beyond; of Laplace's one in 4e3 records of 1e4.
constexpr double step_scales = 12.0;
constexpr double step_part = 1e-3; // of the interval
constexpr double persistent_part = 0.7;
constexpr std::size_t neighbours = 4; // intervals on each side
constexpr std::size_t max_steps = 4;
constexpr double near_whole_periods = 0.25;
constexpr double coarse_tick_part = 1.0 / 16.0; // of the interval
constexpr double one_tick = 1.01;

struct UsualStamps {
  double interval_ns = 0.0;
  double scatter_ns = 0.0;
  double tick_ns = 0.0; // all intervals looked at are multiples of it
};

bool is_trusted(std::span<const std::uint8_t> flags, std::size_t i) {
  return flags.empty() || flags[i] == 0;
}

UsualStamps usual_of(std::span<const std::int64_t> stamps_ns, std::span<const std::uint8_t> flags) {
  const std::size_t stride = std::max<std::size_t>(1, stamps_ns.size() / max_looked_at);
  std::vector<double> intervals_ns;
  std::int64_t tick_ns = 0;
  for (std::size_t i = 1; i < stamps_ns.size(); i += stride) {
    if (is_trusted(flags, i) && is_trusted(flags, i - 1)) {
      const std::int64_t interval_ns = stamps_ns[i] - stamps_ns[i - 1];
      tick_ns = std::gcd(tick_ns, interval_ns);
      intervals_ns.push_back(static_cast<double>(interval_ns));
    }
  }
  if (intervals_ns.empty()) {
    return {};
  }
  UsualStamps usual{upper_median(intervals_ns), 0.0, static_cast<double>(tick_ns)};
  for (double& one : intervals_ns) {
    one = std::abs(one - usual.interval_ns);
  }
  usual.scatter_ns = mad_to_sd * upper_median(intervals_ns);
  return usual;
}

// What is left of a deviation when missing samples are taken off.
double without_missing(double deviation_ns, double interval_ns) {
  if (deviation_ns < 0.5 * interval_ns) {
    return deviation_ns; // nearly all are
  }
  const double periods = std::round(deviation_ns / interval_ns);
  const double rest = deviation_ns - periods * interval_ns;
  return std::abs(rest) < near_whole_periods * interval_ns ? rest : deviation_ns;
}

} // namespace

std::vector<ClockStep> find_clock_steps(std::span<const std::int64_t> stamps_ns,
                                        std::span<const std::uint8_t> flags) {
  std::vector<ClockStep> steps;
  const UsualStamps usual = usual_of(stamps_ns, flags);
  if (stamps_ns.size() < min_samples || usual.interval_ns <= 0.0) {
    return steps;
  }
  const double threshold_ns =
      std::max(step_scales * usual.scatter_ns, step_part * usual.interval_ns);
  // From the `before`-th trusted sample to the `behind`-th.
  const auto deviation_ns = [&](std::size_t before, std::size_t behind) {
    const double all = static_cast<double>(stamps_ns[behind] - stamps_ns[before]) -
                       static_cast<double>(behind - before) * usual.interval_ns;
    return without_missing(all, usual.interval_ns);
  };
  const auto trusted_away = [&](std::size_t from, std::ptrdiff_t direction) {
    std::size_t place = from;
    auto at = static_cast<std::ptrdiff_t>(from);
    for (std::size_t found = 0; found < neighbours;) {
      at += direction;
      if (at < 0 || at >= static_cast<std::ptrdiff_t>(stamps_ns.size())) {
        break;
      }
      if (is_trusted(flags, static_cast<std::size_t>(at))) {
        place = static_cast<std::size_t>(at);
        ++found;
      }
    }
    return place;
  };
  std::size_t last = 0;
  while (last < stamps_ns.size() && !is_trusted(flags, last)) {
    ++last;
  }
  for (std::size_t i = last + 1; i < stamps_ns.size(); ++i) {
    if (!is_trusted(flags, i)) {
      continue;
    }
    const double here = deviation_ns(last, i);
    if (std::abs(here) > threshold_ns) {
      const double around = deviation_ns(trusted_away(last, -1), trusted_away(i, 1));
      const bool stays = around * here > 0.0 && std::abs(around) > persistent_part * std::abs(here);
      const bool is_tick = usual.tick_ns >= coarse_tick_part * usual.interval_ns &&
                           std::abs(here) <= one_tick * usual.tick_ns;
      if (stays && !is_tick) {
        steps.push_back({i, here});
      }
    }
    last = i;
  }
  return steps.size() > max_steps ? std::vector<ClockStep>{} : steps;
}

} // namespace dyncal::analysis
