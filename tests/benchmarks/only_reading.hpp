// What reading costs when nothing else is done with the samples: the measure that the fits are
// compared with.
#pragma once

#include <cstddef>

namespace dyncal::benchmarks {

// With independent sums, so that the loads and not the additions limit.
template <class Number>
inline Number sum_of(const Number* data, std::size_t n) {
  constexpr std::size_t width = 32;
  Number sums[width] = {};
  std::size_t i = 0;
  for (; i + width <= n; i += width) {
    for (std::size_t k = 0; k < width; ++k) {
      sums[k] += data[i + k];
    }
  }
  for (; i < n; ++i) {
    sums[0] += data[i];
  }
  Number total = 0;
  for (const Number one : sums) {
    total += one;
  }
  return total;
}

} // namespace dyncal::benchmarks
