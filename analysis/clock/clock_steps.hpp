// Where the stamps of a record step against its samples and stay there: the clock was set.
//
//   r_i = t_i - t_{i-1} - k m      k samples further, m the median interval
//
// A step is an r beyond 12 s (s = 1.4826 MAD of the intervals) and a thousandth of m, of which more
// than 70 % is left when the four intervals on each side are added: a late or early sample makes
// its own good. Positive ones near whole periods are missing samples and count less these. Stamps
// that are multiples of a coarse tick step by one as they are made, and more than four steps are
// how the source stamps: both are left out. Samples with a flag count as samples, their stamps for
// nothing. Median and MAD are of 256 intervals at most. Units: ns. Pure function, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dyncal::analysis {

struct ClockStep {
  std::size_t sample = 0; // the first behind it
  double size_ns = 0.0;   // > 0: stamps are later than before
};

// `flags` is empty (all are trusted) or as long as the stamps.
[[nodiscard]] std::vector<ClockStep> find_clock_steps(std::span<const std::int64_t> stamps_ns,
                                                      std::span<const std::uint8_t> flags = {});

} // namespace dyncal::analysis
