// Noise with a memory: how large the noise is at the frequency of a sine, against the white noise
// that a fit takes its residuals for.
//
//   factor^2 = density of the residuals near f / their density if they were white
//
// u of the phasor is the white one times `factor`, known with `degrees_of_freedom`.
//
// - From blocks (eight periods and more): the scatter of the block phasors is the density within
//   half a block's bandwidth around f. Only a factor below 1 is given, where white noise shows it
//   once in 10^4: scatter that is larger may be that of the exciter, which the ratio of two
//   channels does not have (ratio_blocks.hpp). Where it wanders, the residuals within the blocks
//   are the noise; those of the record would hold the wandering too.
// - Of few periods p: the residuals' Fourier coefficients c_j at j / T beside f and its harmonic,
//   0 < j < 2 p, each with two degrees of freedom. `white` is false where these, or those up to
//   4 p, are larger than white noise gives once in a thousand (or smaller: a factor below 1).
//
// Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/phasor_blocks.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

inline constexpr double few_periods = 8.0;

struct NoiseNearSignal {
  bool white = true; // the fit's own uncertainty holds
  double factor = 1.0;
  double degrees_of_freedom = 0.0;
};

[[nodiscard]] NoiseNearSignal noise_from_blocks(std::span<const PhasorBlock> blocks,
                                                const SineFit& fit);

// REQUIRES: a fit about `phase_origin_ns`, as many values as stamps.
[[nodiscard]] NoiseNearSignal noise_of_few_periods(const Frequency& frequency,
                                                   std::int64_t phase_origin_ns,
                                                   std::span<const std::int64_t> stamps_ns,
                                                   std::span<const double> values,
                                                   const SineFit& fit);

} // namespace dyncal::analysis
