// Do two results agree? The normalised error of ISO/IEC 17043 and ISO 13528:
//
//   E_n   = (x - y) / sqrt(U_x^2 + U_y^2 - 2 cov)    |E_n| <= 1: they agree
//   chi^2 = d' V^-1 d                                of a complex result, 2 degrees of freedom
//
// u is U / 2 of each, U at 95.45 % with the k of its own degrees of freedom: of few repetitions
// twice the standard uncertainty would not cover.
//
// What both have in common (the same reference, the same method) is given as a covariance of the
// standard uncertainties and must not make the difference look more uncertain than it is. d is
// relative magnitude and phase, taken as independent; E_n is given of both.
//
// Fails: invalid_argument (uncertainty not positive, or a covariance larger than the uncertainties
// allow). Any thread.
#pragma once

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

// u is U / 2.
[[nodiscard]] Expected<double> normalised_error(double x, double u_x, double y, double u_y,
                                                double covariance = 0.0);

struct ComparedResult {
  double magnitude = 0.0;
  double u_magnitude = 0.0; // U / 2
  double phase_rad = 0.0;
  double u_phase_rad = 0.0; // U / 2
};

struct SharedUncertainty { // standard uncertainties of what both results have in common
  double magnitude_rel = 0.0;
  double phase_rad = 0.0;
};

struct ComplexComparison {
  double en_magnitude = 0.0;
  double en_phase = 0.0; // of the difference modulo 2 pi
  double chi_squared = 0.0;
  double probability = 0.0; // that chance gives at least this difference, exp(-chi^2 / 2)
};

[[nodiscard]] Expected<ComplexComparison> compare_transfer(const ComparedResult& x,
                                                           const ComparedResult& y,
                                                           const SharedUncertainty& shared = {});

} // namespace dyncal::analysis
