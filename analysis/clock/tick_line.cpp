#include "analysis/clock/tick_line.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

// A crystal wanders by some 1e-6 of its rate within minutes: by far less than a sixteenth of a tick
// within the 3e4 samples that are remembered so.
constexpr double growth_per_sample = 3e-5;
constexpr double begin_margin_ticks = 1.0 / 64.0; // of the period: a clock jumped, or was learned
constexpr double least_part = 0.25;               // of a period, that this leaves
constexpr double max_growth = 1.0;                // at once, after many samples

} // namespace

TickLine::TickLine(double tick_ns, const PeriodRange& periods, double latency_ticks)
    : tick_ns_(tick_ns), latency_ns_(latency_ticks * tick_ns) {
  corners_ = {{periods.min_ns, 0.0}, {periods.max_ns, 0.0}};
}

void TickLine::begin(std::uint64_t number, std::int64_t stamp_ns) {
  PeriodRange range = periods();
  range.min_ns = std::max(range.min_ns - begin_margin_ticks * tick_ns_, least_part * range.min_ns);
  range.max_ns += begin_margin_ticks * tick_ns_;
  const double low = -latency_ns_;
  const double high = tick_ns_ + latency_ns_;
  corners_ = {{range.min_ns, low}, {range.max_ns, low}, {range.max_ns, high}, {range.min_ns, high}};
  number_ = number;
  stamp_ns_ = stamp_ns;
}

void TickLine::widen(std::uint64_t number, std::int64_t stamp_ns) {
  latency_ns_ = most_latency_ticks * tick_ns_;
  begin(number, stamp_ns);
}

TickLine::Corner TickLine::moved(const Corner& corner, std::uint64_t number,
                                 std::int64_t stamp_ns) const {
  const auto samples = static_cast<double>(static_cast<std::int64_t>(number - number_));
  const auto distance_ns = static_cast<double>(stamp_ns - stamp_ns_);
  return {corner.period_ns, corner.from_stamp_ns + corner.period_ns * samples - distance_ns};
}

std::vector<TickLine::Corner> TickLine::cut(std::uint64_t number, std::int64_t stamp_ns) const {
  std::vector<Corner> corners;
  for (const Corner& one : corners_) {
    corners.push_back(moved(one, number, stamp_ns));
  }
  const double low = -latency_ns_;
  const double high = tick_ns_ + latency_ns_;
  // Inside is where sign (from_stamp - bound) >= 0.
  for (const auto& [bound_ns, sign] : {std::pair(low, 1.0), std::pair(high, -1.0)}) {
    std::vector<Corner> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Corner& from = corners[i];
      const Corner& to = corners[(i + 1) % corners.size()];
      const double begin_ns = sign * (from.from_stamp_ns - bound_ns);
      const double end_ns = sign * (to.from_stamp_ns - bound_ns);
      if (begin_ns >= 0.0) {
        kept.push_back(from);
      }
      if ((begin_ns > 0.0 && end_ns < 0.0) || (begin_ns < 0.0 && end_ns > 0.0)) {
        const double part = begin_ns / (begin_ns - end_ns);
        kept.push_back({std::lerp(from.period_ns, to.period_ns, part), bound_ns});
      }
    }
    corners = std::move(kept);
  }
  return corners;
}

bool TickLine::admits(std::uint64_t number, std::int64_t stamp_ns) const {
  return !cut(number, stamp_ns).empty();
}

bool TickLine::add(std::uint64_t number, std::int64_t stamp_ns) {
  std::vector<Corner> corners = cut(number, stamp_ns);
  if (corners.empty()) {
    return false;
  }
  corners_ = std::move(corners);
  grow(std::abs(static_cast<double>(static_cast<std::int64_t>(number - number_))));
  number_ = number;
  stamp_ns_ = stamp_ns;
  return true;
}

void TickLine::grow(double samples) {
  Corner middle;
  for (const Corner& one : corners_) {
    middle.period_ns += one.period_ns / static_cast<double>(corners_.size());
    middle.from_stamp_ns += one.from_stamp_ns / static_cast<double>(corners_.size());
  }
  const double times = 1.0 + std::min(max_growth, growth_per_sample * samples);
  for (Corner& one : corners_) {
    one.period_ns = std::lerp(middle.period_ns, one.period_ns, times);
    one.from_stamp_ns = std::lerp(middle.from_stamp_ns, one.from_stamp_ns, times);
  }
}

PeriodRange TickLine::periods() const {
  const auto [min, max] = std::minmax_element(
      corners_.begin(), corners_.end(),
      [](const Corner& one, const Corner& other) { return one.period_ns < other.period_ns; });
  return {min->period_ns, max->period_ns};
}

double TickLine::period_ns() const {
  const PeriodRange range = periods();
  return 0.5 * (range.min_ns + range.max_ns);
}

double TickLine::late_ns(std::uint64_t number, std::int64_t stamp_ns) const {
  double sum_ns = 0.0;
  for (const Corner& one : corners_) {
    sum_ns += moved(one, number, stamp_ns).from_stamp_ns;
  }
  return 0.5 * tick_ns_ - sum_ns / static_cast<double>(corners_.size());
}

} // namespace dyncal::analysis
