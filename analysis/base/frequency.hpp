// A frequency that keeps the digits it was written with.
//
// 199.87 is not a double: over six hours the nearest double is 3.2e-10 rad off. A frequency is
// therefore held in turns per nanosecond as an unevaluated sum high + low (about 32 digits), and
// the phase of a time difference is reduced in turns. Any thread; immutable.
#pragma once

#include <cstdint>
#include <string_view>

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

class Frequency {
public:
  // Decimal text such as "12.5", "46.7" or "1e3", in hertz. Fails (frequency_out_of_range) unless
  // it is a finite positive number, (invalid_argument) unless the whole text is one.
  [[nodiscard]] static Expected<Frequency> parse(std::string_view decimal_hz);

  // The double itself, exactly; for frequencies that come out of an estimate. REQUIRES: finite and
  // positive.
  [[nodiscard]] static Frequency from_hz(double hz);

  // This frequency plus a small amount in hertz, keeping the low part.
  [[nodiscard]] Frequency shifted_by_hz(double delta_hz) const;

  // A harmonic of this frequency, with all its digits. REQUIRES: order >= 1.
  [[nodiscard]] Frequency multiple(int order) const;

  [[nodiscard]] double hz() const;
  [[nodiscard]] double angular() const; // rad/s
  [[nodiscard]] double turns_per_ns_high() const { return high_; }
  [[nodiscard]] double turns_per_ns_low() const { return low_; }

  // Phase of a time difference in turns, reduced to [-0.5, 0.5]; error below 2e-16 turns for |dt| <
  // 2^53 ns (104 days).
  [[nodiscard]] double reduced_turns(std::int64_t dt_ns) const;

private:
  Frequency(double high, double low) : high_(high), low_(low) {}
  double high_; // turns per nanosecond
  double low_;
};

} // namespace dyncal::analysis
