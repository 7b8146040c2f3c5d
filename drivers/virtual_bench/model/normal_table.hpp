// Normal numbers for signals of millions of samples: an entry of a table of 4096 values, picked by
// twelve random bits.
//
// The table holds the normal distribution's quantiles at (i + 0.5) / 4096, scaled to a standard
// deviation of 1: numbers up to 3.7 in steps far finer than a converter's. Picked by independent
// bits they are white. Immutable; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace dyncal::drivers::virtual_bench {

class NormalTable {
public:
  static constexpr unsigned bits = 12;

  NormalTable();

  // Of the lowest twelve bits.
  [[nodiscard]] double at(std::uint64_t random_bits) const {
    return values_[random_bits % entries];
  }

private:
  static constexpr std::size_t entries = std::size_t{1} << bits;
  std::array<double, entries> values_{};
};

} // namespace dyncal::drivers::virtual_bench
