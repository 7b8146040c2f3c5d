#include "analysis/clock/first_stamps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr double alike_among_first = 0.9;
constexpr PeriodRange periods_in_ticks = {1.0 / 64.0, 4.5};
constexpr std::size_t first_on_line = 32;
constexpr std::size_t try_every = 8; // one of the first may be the one that is wrong
constexpr std::size_t of_each_in_flicker = 2;
constexpr double most_in_flicker = 0.25;
constexpr double periods_among_first = 0.9;
constexpr double time_in_periods = 0.5; // of the first intervals, but for the longest three
constexpr std::size_t longest_left_out = 3;
constexpr double margin_periods = 0.25;
constexpr double max_margin_periods = 0.75; // with a tick; a whole period is a missing sample
constexpr double coarse_tick_part = 1.0 / 8.0;
constexpr double one_tick = 1.01;

// Of consecutive numbers.
std::vector<double> single_intervals_ns(std::span<const TimedSample> first) {
  std::vector<double> intervals_ns;
  for (std::size_t i = 1; i < first.size(); ++i) {
    if (!first[i].begins_stretch && first[i].number == first[i - 1].number + 1) {
      intervals_ns.push_back(static_cast<double>(first[i].stamp_ns - first[i - 1].stamp_ns));
    }
  }
  return intervals_ns;
}

// Most of the time passes in intervals of about this length. What is read from a FIFO with stamps a
// few ns apart has its time between the read-outs.
bool holds_most_of_the_time(std::vector<double> intervals_ns, double usual_ns) {
  std::sort(intervals_ns.begin(), intervals_ns.end());
  intervals_ns.resize(intervals_ns.size() - std::min(longest_left_out, intervals_ns.size() / 4));
  double usual = 0.0, all = 0.0;
  for (const double one_ns : intervals_ns) {
    all += one_ns;
    usual += one_ns < 2.5 * usual_ns ? one_ns : 0.0;
  }
  return usual >= time_in_periods * all;
}

FirstPeriod period_and_tick(const std::vector<double>& intervals_ns) {
  FirstPeriod result;
  std::vector<double> sorted = intervals_ns;
  const double median_ns = upper_median(sorted);
  std::vector<double> deviations_ns;
  for (const double one_ns : intervals_ns) {
    result.tick_ns = std::gcd(result.tick_ns, std::llround(one_ns));
    deviations_ns.push_back(std::abs(one_ns - median_ns));
  }
  result.period_ns = median_ns;
  result.scatter_ns = mad_to_sd * upper_median(deviations_ns);
  const auto tick_ns = static_cast<double>(result.tick_ns);
  double sum_ns = 0.0;
  std::size_t near = 0;
  bool differ = false;
  for (const double one_ns : intervals_ns) {
    if (std::abs(one_ns - median_ns) < one_tick * tick_ns) {
      sum_ns += one_ns;
      ++near;
      differ = differ || one_ns != median_ns;
    }
  }
  // Intervals that are all alike tell no tick: the period may be one.
  if (differ && tick_ns >= coarse_tick_part * median_ns && tick_ns < median_ns) {
    result.coarse_tick_ns = tick_ns;
    result.period_ns = sum_ns / static_cast<double>(near);
  }
  return result;
}

// Nearly all intervals are one tick, some less, some more: stamps go back and forth between two
// ticks, as a sample clock alone does not.
bool flicker(double tick_ns, std::span<const TimedSample> first) {
  std::size_t less = 0, more = 0;
  for (std::size_t i = 1; i < first.size(); ++i) {
    const auto ticks =
        std::llround(static_cast<double>(first[i].stamp_ns - first[i - 1].stamp_ns) / tick_ns);
    const auto samples = static_cast<std::int64_t>(first[i].number - first[i - 1].number);
    less += ticks < samples ? 1 : 0;
    more += ticks > samples ? 1 : 0;
  }
  return std::min(less, more) >= of_each_in_flicker &&
         static_cast<double>(less + more) <= most_in_flicker * static_cast<double>(first.size());
}

std::optional<TickLine> longest_line(double tick_ns, std::span<const TimedSample> first) {
  const PeriodRange periods = {periods_in_ticks.min_ns * tick_ns,
                               periods_in_ticks.max_ns * tick_ns};
  const double latency_ticks =
      flicker(tick_ns, first) ? TickLine::most_latency_ticks : TickLine::least_latency_ticks;
  std::optional<TickLine> longest;
  std::size_t most = first_on_line - 1;
  for (std::size_t begin = 0; begin + first_on_line <= first.size(); begin += try_every) {
    TickLine line(tick_ns, periods, latency_ticks);
    line.begin(first[begin].number, first[begin].stamp_ns);
    std::size_t count = 1;
    while (begin + count < first.size() &&
           line.add(first[begin + count].number, first[begin + count].stamp_ns)) {
      ++count;
    }
    if (count > most) {
      most = count;
      longest = line;
    }
  }
  return longest;
}

} // namespace

std::optional<std::int64_t> alike_interval_ns(std::span<const TimedSample> first) {
  std::vector<double> single_ns = single_intervals_ns(first);
  const std::int64_t usual_ns = single_ns.empty() ? 0 : std::llround(upper_median(single_ns));
  if (usual_ns <= 0) {
    return std::nullopt;
  }
  std::size_t all = 0, exact = 0;
  bool are_multiples = true;
  for (std::size_t i = 1; i < first.size(); ++i) {
    if (first[i].begins_stretch) {
      continue;
    }
    const std::int64_t distance_ns = first[i].stamp_ns - first[i - 1].stamp_ns;
    const auto numbered = static_cast<std::int64_t>(first[i].number - first[i - 1].number);
    ++all;
    exact += distance_ns == numbered * usual_ns ? 1 : 0;
    are_multiples = are_multiples && distance_ns % usual_ns == 0;
  }
  const bool most = static_cast<double>(exact) >= alike_among_first * static_cast<double>(all);
  return are_multiples && most ? std::optional(usual_ns) : std::nullopt;
}

std::optional<FirstTicks> ticks_of(std::span<const TimedSample> first) {
  std::int64_t tick_ns = 0;
  std::vector<double> distances_ns;
  for (std::size_t i = 1; i < first.size(); ++i) {
    const std::int64_t distance_ns = first[i].stamp_ns - first[i - 1].stamp_ns;
    if (first[i].begins_stretch) {
      return std::nullopt;
    }
    tick_ns = std::gcd(tick_ns, distance_ns);
    if (distance_ns != 0) {
      distances_ns.push_back(static_cast<double>(distance_ns));
    }
  }
  if (distances_ns.empty() ||
      static_cast<double>(tick_ns) < TickLine::least_tick_periods * upper_median(distances_ns)) {
    return std::nullopt;
  }
  auto line = longest_line(static_cast<double>(tick_ns), first);
  return line ? std::optional(FirstTicks{tick_ns, *line}) : std::nullopt;
}

double period_margin_ns(double period_ns, double coarse_tick_ns) {
  return std::min(margin_periods * period_ns + coarse_tick_ns, max_margin_periods * period_ns);
}

bool is_multiple(double distance_ns, double period_ns, double margin_ns) {
  const double times = std::round(distance_ns / period_ns);
  return times >= 1.0 && std::abs(distance_ns - times * period_ns) <= margin_ns;
}

std::optional<FirstPeriod> period_of(std::span<const TimedSample> first) {
  const std::vector<double> intervals_ns = single_intervals_ns(first);
  if (intervals_ns.empty()) {
    return std::nullopt;
  }
  const FirstPeriod result = period_and_tick(intervals_ns);
  const double margin_ns = period_margin_ns(result.period_ns, result.coarse_tick_ns);
  const auto whole = std::count_if(intervals_ns.begin(), intervals_ns.end(), [&](double one_ns) {
    return result.period_ns > 0.0 && is_multiple(one_ns, result.period_ns, margin_ns);
  });
  const bool are_periods =
      static_cast<double>(whole) >= periods_among_first * static_cast<double>(intervals_ns.size());
  return are_periods && holds_most_of_the_time(intervals_ns, result.period_ns)
             ? std::optional(result)
             : std::nullopt;
}

} // namespace dyncal::analysis
