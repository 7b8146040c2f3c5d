// The frequency of a sine of which nothing is known, good enough to start the four-parameter fit
// (sine_fit.hpp).
//
// The samples are put on an even grid of the median sample interval (gaps stay empty), their mean
// is taken out, and the largest line of the Hann-windowed discrete Fourier transform is
// interpolated (Grandke 1983). Several columns count by their power over their variance. At most
// the first 2^20 grid points are used, and so many of them that the transform is quick. Good to
// about 0.1 of a bin 1/T from three cycles on, to about a bin below.
//
// A record may drift: where the largest line has fewer than four cycles, or does not stand out of
// its surroundings, the highest line of a column without its best cubic is taken if that does.
//
// Fails: too_few_samples (fewer than eight), not_finite, stamps_not_increasing, no_excitation (all
// columns constant, noise alone, or a drift alone), invalid_argument (sizes). No state; any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/base/progress.hpp"

namespace dyncal::analysis {

[[nodiscard]] Expected<Frequency>
estimate_frequency(std::span<const std::int64_t> stamps_ns,
                   std::span<const std::span<const double>> columns, const Progress& progress = {});

} // namespace dyncal::analysis
