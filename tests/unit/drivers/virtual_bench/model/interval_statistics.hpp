// Statistics of a list of intervals, computed plainly. For tests only.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace dyncal::drivers::virtual_bench {

struct IntervalStatistics {
  double mean = 0.0;
  double sd = 0.0;
  double spread = 0.0;
};

inline IntervalStatistics statistics_of(const std::vector<double>& values) {
  IntervalStatistics result;
  double lowest = values.front();
  double highest = values.front();
  for (const double value : values) {
    result.mean += value / static_cast<double>(values.size());
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  for (const double value : values) {
    result.sd += (value - result.mean) * (value - result.mean) / static_cast<double>(values.size());
  }
  result.sd = std::sqrt(result.sd);
  result.spread = highest - lowest;
  return result;
}

} // namespace dyncal::drivers::virtual_bench
