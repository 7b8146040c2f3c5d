// The DAU's clock seen through sync: which events of the stamps are the clock's, and which are the
// sensor's. No program uses it yet.
//
// Sync is a steady sine, so its phase in the DAU's stamps is a clock comparison. Block k of a step
// gives
//
//   x_k = arg(P_k / P) / w,   u(x_k) = u(theta_k) / w
//
// with P_k the block's phasor about one instant at the step's refined frequency. A clock that jumps
// by +D makes every later stamp too large, the sine seems to come late: x steps by -D. A sample
// that the sensor takes late or early leaves x where it was, for its stamp is true.
//
// Verdict on an event of size D at time t, d = mean x after - mean x before (up to four blocks on
// each side, without the one that holds t):
//
//   dau_clock  |d + D| < 4 u(d) and |D| > 8 u(d)
//   sensor     |d| < 4 u(d) and |D| > 8 u(d)
//   undecided  otherwise
//
// Fails as sine_fit.hpp does; too_few_samples for fewer than three blocks. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct ClockComparison {
  std::int64_t begin_ns = 0; // of the block, in the DAU's stamps
  std::int64_t end_ns = 0;
  double error_s = 0.0; // x
  double u_error_s = 0.0;
};

// Blocks of `periods` whole periods each, what is left at the end is not used.
[[nodiscard]] Expected<std::vector<ClockComparison>>
compare_clock_with_sync(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                        std::span<const double> sync, int periods);

enum class EventOrigin { undecided, dau_clock, sensor };

[[nodiscard]] EventOrigin origin_of_event(std::span<const ClockComparison> comparisons,
                                          std::int64_t event_ns, double size_s);

} // namespace dyncal::analysis
