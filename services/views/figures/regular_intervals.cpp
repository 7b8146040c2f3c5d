#include "services/views/figures/regular_intervals.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline views::figures {

RegularIntervals::RegularIntervals(std::vector<WeightedInterval> intervals) {
  std::erase_if(intervals,
                [](const auto& i) { return !std::isfinite(i.interval_ns) || !(i.weight > 0); });
  std::sort(intervals.begin(), intervals.end(),
            [](const auto& a, const auto& b) { return a.interval_ns < b.interval_ns; });
  double half = 0;
  for (const auto& interval : intervals) {
    half += interval.weight / 2;
  }
  for (const auto& interval : intervals) {
    median_ns_ = interval.interval_ns;
    half -= interval.weight;
    if (half <= 0) {
      break;
    }
  }
}

bool RegularIntervals::contain(double interval_ns) const {
  return std::abs(interval_ns - median_ns_) <= 0.5 * std::abs(median_ns_);
}

} // namespace dyncal::inline views::figures
