// A sample rate as an exact fraction, so that stamps of hours of samples carry no rounding of the
// rate. Any thread; plain data.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers {

struct SampleRate { // hertz
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;

  [[nodiscard]] double hz() const {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
  // REQUIRES: positive, and denominator below 9.2e9.
  [[nodiscard]] RegularClock clock(std::int64_t origin_ns) const {
    return {origin_ns, 1'000'000'000 * denominator, numerator};
  }
};

// The fraction of the shortest decimal text that names this double: 51200.5 is 102401/2. Nothing
// unless 1e-6 <= hz <= 1e9 and the text has at most nine decimals.
[[nodiscard]] std::optional<SampleRate> sample_rate_from_hz(double hz);

} // namespace dyncal::drivers
