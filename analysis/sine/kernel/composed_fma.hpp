// a b + c with one rounding, composed of exact operations, for processors without a fused
// multiply-add.
//
// After Boldo and Melquiond, "Emulation of a FMA and correctly rounded sums: proved algorithms
// using rounding to odd", IEEE Trans. Computers 57 (2008): Dekker's product, two exact sums, and
// one sum rounded to odd. The result equals std::fma bit for bit while |a|, |b| < 2^990 and neither
// product nor sums come near the subnormal range; otherwise it may differ in the last place.
#pragma once

#include <cstdint>

namespace dyncal::analysis::kernel {

using Double2 = double __attribute__((vector_size(16)));
using Bits2 = std::int64_t __attribute__((vector_size(16)));

struct ExactPair {
  Double2 high, low;
};

inline ExactPair exact_sum(Double2 a, Double2 b) {
  const Double2 sum = a + b;
  const Double2 part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

inline ExactPair exact_product(Double2 a, Double2 b) {
  constexpr double splitter = 134217729.0; // 2^27 + 1
  const Double2 scaled_a = a * splitter;
  const Double2 scaled_b = b * splitter;
  const Double2 a_high = scaled_a - (scaled_a - a);
  const Double2 b_high = scaled_b - (scaled_b - b);
  const Double2 a_low = a - a_high;
  const Double2 b_low = b - b_high;
  const Double2 product = a * b;
  return {product,
          a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)};
}

// The sum, or its odd neighbour on the side of the exact value when it is inexact: a later rounding
// cannot go wrong twice.
inline Double2 sum_rounded_to_odd(Double2 a, Double2 b) {
  const ExactPair sum = exact_sum(a, b);
  const Bits2 bits = reinterpret_cast<Bits2>(sum.high);
  const Double2 zero = {0.0, 0.0};
  const Bits2 one = {1, 1};
  const Bits2 inexact = (sum.low != zero);
  const Bits2 even = (bits & one) != one;
  const Bits2 away =
      (sum.low > zero) ^ (sum.high < zero); // -1: the exact value has the larger magnitude
  const Bits2 step = (away & one) | ~away;  // +1 or -1
  return reinterpret_cast<Double2>(bits + (step & inexact & even));
}

inline Double2 composed_fma(Double2 a, Double2 b, Double2 c) {
  const ExactPair product = exact_product(a, b);
  const ExactPair low = exact_sum(c, product.low);
  const ExactPair high = exact_sum(product.high, low.high);
  return high.high + sum_rounded_to_odd(low.low, high.low);
}

} // namespace dyncal::analysis::kernel
