// Straight lines through phases that are known modulo 2 pi: each delay that a sensor may have and
// the phases allow.
//
//   psi_i + 2 pi n_i = psi_0 - 2 pi f_i tau        weighted least squares, chi^2 of the residuals
//
// Frequencies that are all multiples of a spacing D leave tau open by multiples of 1 / D, and two
// frequencies always do. So what a sensor may have is stated: 0 <= tau <= 50 ms (a low pass of 5 Hz
// has 32), within 3 u, and a phase that tends to 0 or pi at 0 Hz within 0.5 rad. A line fits
// when chance gives its chi^2 more often than once in a thousand.
//
// Plain functions; two points and more. Any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/response/group_delay.hpp"

namespace dyncal::analysis {

struct DelayLine {
  double delay_s = 0.0;
  double intercept_rad = 0.0;
  double variance_delay = 0.0;
  double variance_intercept = 0.0;
  double covariance = 0.0;
  double chi_squared = 0.0;

  [[nodiscard]] double at(double frequency_hz) const;
};

// Through unwrapped phases. Errors in common lie in the space of the model, so they change neither
// estimate nor residuals and only add to the covariance: weights of the independent parts alone
// give the estimate of generalised least squares.
[[nodiscard]] DelayLine fit_delay_line(std::span<const PhasePoint> points,
                                       const std::vector<double>& unwrapped_rad);

struct DelayBranch {
  DelayLine line;
  std::vector<double> unwrapped_rad;
};

// In the order of their delays.
[[nodiscard]] std::vector<DelayBranch> delay_branches(std::span<const PhasePoint> points);

} // namespace dyncal::analysis
