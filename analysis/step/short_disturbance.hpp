// A knock: a short stretch of a record in which something far beside the sine was recorded.
//
// Residuals of a sine approximation are taken in windows of 5 ms, eight samples at least. A window
// stands out where its rms is more than eight times the median of all (5.4 standard deviations of
// noise that is slow against a window, so normal noise of any colour does not). The approximation
// is repeated without these windows and their neighbours until they stay the same.
//
// It is one only where the windows are one stretch of at most a tenth of the record, what remains
// is ordinary, and fewer than half of its values repeat: clipped tops come with every period,
// stuck samples repeat, hum does not end. Empty otherwise.
//
// Cost: a few fits. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct ShortDisturbance { // stamps, both inclusive
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
};

[[nodiscard]] std::optional<ShortDisturbance>
find_short_disturbance(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                       std::span<const double> values);

} // namespace dyncal::analysis
