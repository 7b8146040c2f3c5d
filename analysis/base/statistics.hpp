// Order statistics and moments of a list of numbers, each in the definition its name states.
//
// With x_(0) <= x_(1) <= ... <= x_(n-1):
//
//   upper_median        x_(floor(n / 2)): one of the values, also when n is even
//   median              the same when n is odd, else half of x_(n/2 - 1) + x_(n/2)
//   quantile_value      x_(floor(p (n - 1))): one of the values
//   quantile_of_sorted  linear between x_(h) and x_(h + 1), h = floor(p (n - 1)): R-7 of Hyndman
//                       and Fan
//   mean_repeats        values a distinct value, without itself: 0 when no two are equal
//
// All need one value at least (standard_deviation two) and p in [0, 1]. Any thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace dyncal::analysis {

// What makes a median absolute deviation the standard deviation of a normal distribution.
inline constexpr double mad_to_sd = 1.4826;

// Reorders what it is given.
template <class Value>
[[nodiscard]] Value upper_median(std::span<Value> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Value>
[[nodiscard]] Value upper_median(std::vector<Value>& values) {
  return upper_median(std::span<Value>(values));
}

[[nodiscard]] double median(std::vector<double> values);
[[nodiscard]] double quantile_value(std::vector<double> values, double probability);
[[nodiscard]] double quantile_of_sorted(std::span<const double> sorted, double probability);

[[nodiscard]] double mean(std::span<const double> values);
[[nodiscard]] double mean_repeats(std::vector<double> values);
[[nodiscard]] double standard_deviation(std::span<const double> values); // n - 1

} // namespace dyncal::analysis
