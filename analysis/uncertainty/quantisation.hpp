// What the steps q of a converter do to a sine approximation when the noise s is too small to hide
// them.
//
// Noise of half a step or more (s >= q / 2) makes quantisation a white noise of q^2 / 12 that the
// residuals contain: nothing is to be added. Below, with the damping D = exp(-2 pi^2 (s / q)^2),
//
//   u(A)     = D min(0.53 q / sqrt(A / q), 2 q / pi) / sqrt(3)
//   u(theta) = D rms of the phase errors of sines that are rounded at the same instants
//
// The amplitude's error is bounded by the Bessel series over all offsets (below one step the sine
// may vanish in it) and taken as rectangular. The phase is free of this by symmetry where the
// samples meet all phases of the sine alike: what is left depends on which phases they meet, from
// q / (A sqrt(6 n)) for the n phases of a sine in step with the sampling to hundreds of times less.
// So it is tried out: sixteen sines of this frequency, within half a step of this amplitude, with
// any phase and offset. Beyond 65536 samples the first ones tell, which err more than all.
//
// Units: those of the samples; radians. Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct QuantisationUncertainty {
  double u_amplitude = 0.0;
  double u_phase_rad = 0.0;
};

// `residual_sd` is that of the fit, quantisation included; `resolution` one step, 0: none.
[[nodiscard]] QuantisationUncertainty
quantisation_uncertainty(double amplitude, double residual_sd, double resolution,
                         const Frequency& frequency, std::span<const std::int64_t> stamps_ns);

} // namespace dyncal::analysis
