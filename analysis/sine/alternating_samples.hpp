// Are the samples of a sine in turn of two sensors, or of two gains? Their difference is a sine of
// alternating sign in the residuals, a line at half the rate less the signal's frequency:
//
//   d = 2/n sum (-1)^k e_k e^{-i phi_k} / A     k: number of the sample, by the stamps' intervals
//
// The fitted amplitude is the mean of both, and either is off by |d|. Certain: |d| beyond 1e-4,
// 4.5 times what the residuals' noise gives, and twice the largest of four lines beside it, two and
// four resolutions away. Not judged where less than six resolutions are between the line and
// the signal or half the rate; beyond a twentieth only, where a harmonic of the signal or of the
// mains folds there. The middle 8192 samples at most.
//
// What one step cannot show, many may (services/evaluation/channel_faults.hpp): the difference of
// the gains is the part of d in phase with the signal, whose sign depends on which of the two was
// first. Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

struct AlternatingPart {
  double certain_rel = 0.0; // |d|, 0: not certain
  double gain_rel = 0.0;    // part of d in phase with the signal
  double u_gain_rel = 0.0;  // by the noise, or the lines beside it; 0: not judged
};

// `fit` about `origin_ns`, of `values`.
[[nodiscard]] AlternatingPart alternating_part(const Frequency& frequency, const SineFit& fit,
                                               std::int64_t origin_ns,
                                               std::span<const std::int64_t> stamps_ns,
                                               std::span<const double> values);

} // namespace dyncal::analysis
