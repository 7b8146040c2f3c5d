// What the steps q of a converter do to a sine approximation when the noise s is too small to hide
// them.
//
// Noise of half a step or more (s >= q / 2) makes quantisation a white noise of q^2 / 12 that the
// residuals contain: nothing is to be added. Below, with the damping D = exp(-2 pi^2 (s / q)^2),
//
//   u(A)     = D min(0.53 q / sqrt(A / q), 2 q / pi) / sqrt(3)
//   u(theta) = D q / (sqrt(12) A) sqrt(2 / n_period)
//
// The amplitude's error is bounded by the Bessel series over all offsets (below one step the sine
// may vanish in it) and taken as rectangular. The phase is free of this by symmetry, but samples at
// the same phases of every period repeat their errors, which then average over one period only.
//
// Units: those of the samples; radians. Any thread.
#pragma once

namespace dyncal::analysis {

struct QuantisationUncertainty {
  double u_amplitude = 0.0;
  double u_phase_rad = 0.0;
};

// `residual_sd` is that of the fit, quantisation included; `resolution` one step, 0: none.
[[nodiscard]] QuantisationUncertainty quantisation_uncertainty(double amplitude, double residual_sd,
                                                               double resolution,
                                                               double samples_per_period);

} // namespace dyncal::analysis
