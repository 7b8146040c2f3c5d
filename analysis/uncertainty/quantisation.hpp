// What the steps of a converter do to a sine approximation when the noise is too small to hide
// them.
//
// Noise of half a step or more (s >= q/2) makes quantisation a white noise of q^2/12 that the
// residuals contain: nothing is to be added. Below, the amplitude is off by up to 0.53 q /
// sqrt(A/q) (bound of the Bessel series over all offsets; below one step the sine may vanish in it:
// 2 q / pi), damped by exp(-2 pi^2 (s/q)^2); a rectangular distribution is taken, / sqrt(3). The
// phase is free of this by symmetry, but samples at the same phases of every period repeat their
// errors, which then average over one period only: q / (sqrt(12) A) sqrt(2 / n_period). Units:
// those of the samples; radians.
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
