// One clock against another from the phases of a sync signal that both recorded in several
// excitation steps: the time error as a polynomial shared by all steps, robustly. No program uses
// it yet.
//
//   theta_sk = a_s + w_s x(t_k)
//   x(t)     = c_1 u + c_2 u^2 + ... + c_m u^m,   u = (t - t_0) / T in [-1, 1]
//
// theta_sk is the phase of step s in block k against the frequency w_s of the step in the other
// clock, lead, unwrapped within the step; a_s is free, for the sine starts anywhere. x > 0: this
// clock's stamps are too small for the phase that has passed, the clock is slow by x; -x'(t) is its
// rate error. So a clock's drift is seen through steps of any frequency at once, and a step of the
// clock shows as residuals of one part of the run. Solved with Huber's loss, with covariance.
//
// Fails: invalid_argument (sizes, order, uncertainties), and as least_squares.hpp does. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/response/least_squares.hpp"

namespace dyncal::analysis {

struct BlockPhase {
  std::size_t step = 0;           // 0, 1, 2 ...
  std::int64_t time_ns = 0;       // middle of the block
  double angular_frequency = 0.0; // rad/s, of the step
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
};

struct ClockPolynomial {
  std::int64_t origin_ns = 0;          // t_0
  double half_span_s = 1.0;            // T
  std::vector<double> coefficients_s;  // c_1 ... c_m
  std::vector<double> covariance;      // of the coefficients, row by row
  std::vector<double> step_phases_rad; // a_s
  std::vector<double> residuals_s;     // (theta - model) / w, one per block
  double chi_squared = 0.0;
  double degrees_of_freedom = 0.0;

  [[nodiscard]] double time_error_s(std::int64_t time_ns) const; // x
  [[nodiscard]] double rate_error(std::int64_t time_ns) const;   // x', s/s
};

[[nodiscard]] Expected<ClockPolynomial> fit_clock_polynomial(std::span<const BlockPhase> blocks,
                                                             int order, Loss loss = Loss::huber);

} // namespace dyncal::analysis
