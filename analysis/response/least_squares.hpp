// Nonlinear least squares on model level (some ten to ten thousand residuals).
//
//   minimise 1/2 sum_i rho(r_i(x)^2),   C(x*) = s^2 (J'J)^-1
//
// Ceres searches (Levenberg-Marquardt, Levenberg from a narrow trust region, dogleg; dense QR; the
// lowest of the three minima counts); full Gauss-Newton steps then bring the minimum to the limit
// of double precision, which the cost alone cannot show. Search::quick takes the first strategy
// alone: for telling many starting points apart.
//
// Residuals of a problem with known uncertainties are divided by them (r_i has unit variance): s^2
// = 1. For residuals in the unit of the data s^2 = rss / (n - p). With a robust loss C =
// mean(psi^2) / mean(psi')^2 (J'J)^-1 (Huber), mean(psi^2) taken over n - p.
//
// Fails: too_few_samples (fewer residuals than parameters), not_finite (no value at the start),
// not_converged (with Ceres' reason), ill_conditioned (parameters that the residuals do not
// determine: reciprocal condition of the scaled Jacobian below 1e-12). One thread. Nothing is
// printed.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

enum class Loss {
  none,
  huber, // quadratic within 1.345, linear beyond
  tukey  // without influence beyond 4.685
};

enum class ResidualVariance {
  known,    // residuals have unit variance
  estimated // from the residuals
};

enum class Search { thorough, quick };

struct LeastSquaresProblem {
  std::size_t residuals = 0;
  std::vector<double> start;
  // Fills the residuals and, unless it is empty, the Jacobian (row by row, residuals x parameters).
  // False: no value there.
  std::function<bool(std::span<const double> parameters, std::span<double> residuals,
                     std::span<double> jacobian)>
      evaluate;
  Loss loss = Loss::none;
  ResidualVariance variance = ResidualVariance::known;
  Search search = Search::thorough;
};

struct LeastSquaresSolution {
  std::vector<double> parameters;
  std::vector<double> covariance; // row by row
  double rss = 0.0;               // sum of squared residuals, without the loss
  double degrees_of_freedom = 0.0;
  int iterations = 0;

  [[nodiscard]] double u(std::size_t parameter) const;
  [[nodiscard]] double covariance_of(std::size_t a, std::size_t b) const {
    return covariance[a * parameters.size() + b];
  }
};

[[nodiscard]] Expected<LeastSquaresSolution>
solve_least_squares(const LeastSquaresProblem& problem);

} // namespace dyncal::analysis
