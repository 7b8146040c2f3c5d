// Histogram of sample intervals on the lattice of the stamping counter, and the modes of its shape.
//
// Stamps of a counter with the tick q make intervals that are whole ticks: with bins of another
// width any distribution looks like a comb. Bins are therefore whole ticks (several, when there
// would be more than 4096 bins); without a known tick, max(1 ns, a quarter of the robust standard
// deviation).
//
//   L = |sum exp(2 pi i d / q)| / n   lattice statistic: 1 when every interval is a whole number of
//                                     ticks, 0 when none is preferred
//
// Modes are peaks of the histogram after five Richardson-Lucy steps against the triangular error of
// two quantised stamps (1/6, 2/3, 1/6 of neighbouring ticks) that exceed the higher of the two
// valleys beside them by five standard deviations of the counts and by two per cent of the peak.
// They are looked for only when the tick is known: otherwise they cannot be told from the comb.
//
// Units: ns. Any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/clock/interval_counts.hpp"

namespace dyncal::analysis {

struct IntervalHistogramBin {
  std::int64_t ticks = 0; // interval in ticks (in bins where the tick is not known)
  double interval_ns = 0.0;
  std::uint64_t count = 0;
};

struct IntervalHistogram {
  double bin_ns = 1.0;
  std::vector<IntervalHistogramBin> bins; // not empty, rising
};

// `tick_ns` 0: not known. REQUIRES: a distribution that is not empty.
[[nodiscard]] IntervalHistogram interval_histogram(const IntervalDistribution& distribution,
                                                   double tick_ns, double robust_sd_ns);
[[nodiscard]] double lattice_statistic(const IntervalDistribution& distribution, double tick_ns);
[[nodiscard]] std::vector<double> interval_modes_ns(const IntervalHistogram& histogram);

} // namespace dyncal::analysis
