// Do two results agree? The normalised error of ISO/IEC 17043 and ISO 13528:
//
//   E_n   = (x - y) / U              |E_n| <= 1: they agree
//   U^2   = U_x^2 + U_y^2 - 8 cov    each U at 95.45 % with the k of its own degrees of freedom
//   u^2   = u_x^2 + u_y^2 - 2 cov,   k = U / u,   nu_eff of u_x and u_y (GUM G.4)
//   chi^2 = 4 (E_n^2 of magnitude + E_n^2 of phase), 2 degrees of freedom
//
// Of few repetitions twice the standard uncertainty would not cover, so that it is U that counts.
//
// What both have in common (the same reference, the same method) is given as a covariance of the
// standard uncertainties and must not make the difference look more uncertain than it is. A complex
// result is compared in relative magnitude and phase, taken as independent.
//
// Fails: invalid_argument (uncertainty not positive, or a covariance larger than the uncertainties
// allow). Any thread.
#pragma once

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

struct Difference {
  double value = 0.0;
  CombinedUncertainty of_value;

  [[nodiscard]] double normalised_error() const { return value / of_value.expanded(); } // E_n
};

[[nodiscard]] Expected<Difference> difference_of(double x, const CombinedUncertainty& of_x,
                                                 double y, const CombinedUncertainty& of_y,
                                                 double covariance = 0.0);

struct ComparedResult {
  double magnitude = 0.0;
  CombinedUncertainty of_magnitude;
  double phase_rad = 0.0;
  CombinedUncertainty of_phase;
};

struct SharedUncertainty { // standard uncertainties of what both results have in common
  double magnitude_rel = 0.0;
  double phase_rad = 0.0;
};

struct ComplexComparison {
  Difference magnitude;
  Difference phase; // rad, modulo 2 pi
  double chi_squared = 0.0;
  double probability = 0.0; // that chance gives at least this difference, exp(-chi^2 / 2)
};

[[nodiscard]] Expected<ComplexComparison> compare_transfer(const ComparedResult& x,
                                                           const ComparedResult& y,
                                                           const SharedUncertainty& shared = {});

} // namespace dyncal::analysis
