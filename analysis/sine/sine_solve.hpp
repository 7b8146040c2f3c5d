// From sums to parameters: the 3 x 3 problem of sine approximation by centred normal equations.
//
// Model about a start value p0 = (A0, B0, C0), basis s_i = sin, c_i = cos of the phase about an
// origin:
//
//   y_i = A s_i + B c_i + C
//   e_i = y_i - (A0 s_i + B0 c_i + C0)
//
// The constant is eliminated first (a = SS - S S / n, ...), which keeps 1e-13 down to a fiftieth of
// a cycle. Since the sums are of e and not of y, the residual sum of squares comes out of EE - d'g
// with the digits of the noise, not of the offset. Used by every form of the fit (whole record,
// refined frequency). No allocation, any thread.
#pragma once

#include <array>

#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis::kernel {

// Inverse of the centred 2 x 2 matrix and what leads back to the constant.
struct NormalMatrix {
  double n = 0.0;
  double s_mean = 0.0, c_mean = 0.0;
  double inverse_aa = 0.0, inverse_ab = 0.0, inverse_bb = 0.0;
  double smallest = 0.0; // smallest eigenvalue of the centred matrix, over n: 0.5 for many cycles,
                         // 0 when nothing can be told apart

  NormalMatrix(double samples, const DesignSums& sums);

  // Below this the parameters cannot be told apart: less than about a hundredth of a cycle, or a
  // stroboscopic rate.
  static constexpr double min_allowed = 1e-8;
  [[nodiscard]] bool well_conditioned() const { return smallest > min_allowed; }
};

struct Solution {
  Parameters p;    // start + step
  Parameters step; // what was added to the start value
  double rss = 0.0;
  double ee = 0.0; // residual sum of squares of the start value
};

[[nodiscard]] Solution solve(const NormalMatrix& matrix, const ResidualSums& sums,
                             const Parameters& start);

// Covariance of (A, B, C) for unit variance: AA, AB, AC, BB, BC, CC.
[[nodiscard]] std::array<double, 6> unit_covariance(const NormalMatrix& matrix);

// The phasor and its covariance about another phase origin: P e^{i 2 pi turns}.
void rotate(SineFit& fit, double turns);

// sin and cos of an angle in turns within [-0.5, 0.5], error 1.3e-16.
struct SinCos {
  double sine, cosine;
};
[[nodiscard]] SinCos sine_cosine_of_turns(double turns);

// A phasor stands out of the noise when its amplitude is at least four standard uncertainties:
// noise alone does so once in 3000. When the largest of several independent frequencies was picked,
// the limit rises so that this stays.
[[nodiscard]] bool is_significant(const SineFit& fit, double picked_from = 1.0);

} // namespace dyncal::analysis::kernel
