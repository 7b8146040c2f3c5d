// Group delay of a sensor from its phase over frequency, tau = -d psi / d w (never d psi / d f), by
// generalised least squares:
//
//   psi(f) = psi_0 - 2 pi f tau
//   V      = diag(u_i^2) + u_delay^2 w w' + u_phase^2 1 1'
//
// psi is lead in radians: a delay has falling phase, and tau is positive for it (the paper's lag
// rises). A delay error common to all frequencies goes into u(tau) in full, a common phase error
// into u(psi_0).
//
// Unwrapping: the delay for which the phases agree best is searched over +-1/2 of the smallest
// frequency spacing (periodogram of the unit phasors, six points and more), else predicted from the
// two points before; what remains is unwrapped from point to point and must stay below pi - 3 u at
// each step. Where that line does not fit and that of a delay that a sensor may have does
// (delay_branches.hpp), it is that one; other delays that fit as well are `alternatives_s`. Points
// whose u is above 0.5 rad follow the line and do not count. psi_0 is reduced to
// (-pi, pi]; polarity is inverted when it is nearer to pi than to 0: unwrapping never absorbs that.
//
// U = k u at 95.45 % from u (k = 1) and degrees of freedom of every phase and of what all share: u
// of the phases is known from the same scatter at all frequencies, so of their part
// nu = (sum v_i)^2 / (sum v_i / sqrt(nu_i))^2, v_i its share of the variance; the common part is
// independent of it (coverage.hpp).
//
// When the residuals are larger than u allows once in a thousand (chi-squared), that part grows by
// the Birge ratio, of n - 2 degrees of freedom: the phase is then not a straight line.
//
// Fails: invalid_argument (frequencies not rising, u not positive), too_few_samples (fewer than two
// points that count), not_converged (cannot be unwrapped; the message says where). Any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

// How well an uncertainty U / 2 is known: u (k = 1) is 2 / k of it.
struct KnownTo {
  double k = 2.0;
  double degrees_of_freedom = infinite_degrees_of_freedom;
};

struct PhasePoint {
  double frequency_hz = 0.0;
  double phase_rad = 0.0;   // modulo 2 pi
  double u_phase_rad = 0.0; // U / 2, independent from point to point
  KnownTo known{};
};

struct CommonPhaseUncertainty { // shared by all points
  double delay_s = 0.0;         // U / 2
  double phase_rad = 0.0;
  KnownTo delay_known{};
};

struct GroupDelay {
  double delay_s = 0.0;
  CombinedUncertainty of_delay{};
  double intercept_rad = 0.0; // psi_0
  CombinedUncertainty of_intercept{};
  double cov_delay_intercept = 0.0; // s rad, as of U / 2
  bool polarity_inverted = false;
  std::vector<double> alternatives_s; // delays that a sensor may have and that fit as well
  double chi_squared = 0.0;
  double degrees_of_freedom = 0.0;
  std::vector<double> unwrapped_rad;    // of all points
  std::vector<double> phase_covariance; // V, row by row

  // U / 2, so that the factor 2 covers.
  [[nodiscard]] double u_delay_s() const { return 0.5 * of_delay.expanded(); }
  [[nodiscard]] double u_intercept_rad() const { return 0.5 * of_intercept.expanded(); }
};

[[nodiscard]] Expected<GroupDelay> evaluate_group_delay(std::span<const PhasePoint> points,
                                                        const CommonPhaseUncertainty& common = {});

} // namespace dyncal::analysis
