// One transfer function value from repeated measurements at the same frequency.
//
//   H       = sum(H_i) / n                                mean of the phasors
//   e_i     = H_i / H - 1                                 real part magnitude, imaginary part phase
//   u_a     = max(s / sqrt(n), rms(u_random) / sqrt(n))   observed, and expected from the fits
//   u_c^2   = u_a^2 + u_common^2                          U = k u_c at 95.45 %
//
// s, the sample standard deviation of e_i, has n - 1 degrees of freedom. What is common to all
// repetitions (reference, ADC, delays) does not average; of observed and expected the wider
// interval counts. nu_eff is that of Welch and Satterthwaite.
//
// k(nu_eff) alone (GUM G.4) covers only 93 % with n = 3 and a common part of 0.2..0.5 u_a;
// expanding the parts one by one and adding squares covers up to 98 %. k lies a third of the way
// between: 94.1..96.5 % for n = 3 and any common part (Monte Carlo), exact without one (k = 4.53
// for n = 3). `u_magnitude` and `u_phase_rad` are U / 2, so that the factor 2 that every reader
// applies covers 95.45 % although n is small; u_c, nu_eff and k are given as well. A mean below 10
// u has the phase uncertainty of phasor.hpp.
//
// Fails: invalid_argument (no repetition), not_finite. Any thread.
#pragma once

#include <complex>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

struct Repetition {
  std::complex<double> h;
  double u_random_magnitude_rel = 0.0; // independent from repetition to repetition
  double u_random_phase_rad = 0.0;
  double u_common_magnitude_rel = 0.0; // the same in all of them
  double u_common_phase_rad = 0.0;
};

// Divides a budget: rows that are drawn anew in every repetition are random, but for the part of
// the magnitude that lasts; the others are common to all repetitions (Contribution::repeats).
[[nodiscard]] Repetition make_repetition(std::complex<double> h,
                                         std::span<const Contribution> budget);

struct CombinedUncertainty {
  double u = 0.0;                                          // combined standard uncertainty u_c
  double degrees_of_freedom = infinite_degrees_of_freedom; // nu_eff
  double k = 2.0;                                          // at 95.45 %, see above
};

struct RepetitionMean {
  std::complex<double> h;
  double magnitude = 0.0;
  double u_magnitude = 0.0; // U / 2
  double phase_rad = 0.0;   // (-pi, pi]
  double u_phase_rad = 0.0; // U / 2
  double u_independent_phase_rad =
      0.0; // U / 2 without the common part: for the regression over frequency
  double scatter_magnitude = 0.0; // s of one repetition, in the unit of the magnitude; 0 for n = 1
  double scatter_phase_rad = 0.0;
  std::size_t repetitions = 0;
  CombinedUncertainty magnitude_rel;
  CombinedUncertainty phase;
};

[[nodiscard]] Expected<RepetitionMean> mean_of_repetitions(std::span<const Repetition> repetitions);

} // namespace dyncal::analysis
