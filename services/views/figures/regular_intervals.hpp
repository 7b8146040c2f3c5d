// Tells intervals that the sample clock made from those that a lost or doubled sample made.
#pragma once

#include <utility>
#include <vector>

namespace dyncal::inline views::figures {

struct WeightedInterval {
  double interval_ns;
  double weight;
};

// An interval within half of the median is regular.
class RegularIntervals {
public:
  explicit RegularIntervals(std::vector<WeightedInterval> intervals);
  [[nodiscard]] bool contain(double interval_ns) const;

private:
  double median_ns_ = 0;
};

} // namespace dyncal::inline views::figures
