// Law of propagation of uncertainty for a result with correlated inputs, and its coverage interval
// (GUM 5.2.2, G.4).
//
//   u_c^2  = sum_i (c_i u_i)^2 + 2 sum_{i<j} c_i c_j u_i u_j r_ij
//   nu_eff = u_c^4 / sum_i (c_i u_i)^4 / nu_i
//   U      = k(nu_eff) u_c
//
// u_i are standard uncertainties whatever the distribution (distribution.hpp). Inputs that are
// correlated should have infinite degrees of freedom: Welch-Satterthwaite knows only independent
// ones.
//
// Fails: invalid_argument (u negative or not a number, nu not positive, |r| > 1, an index that does
// not exist, correlations that contradict each other so that a variance would be negative). Any
// thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/contribution.hpp"
#include "analysis/uncertainty/distribution.hpp"

namespace dyncal::analysis {

struct InputQuantity {
  std::string name;
  double value = 0.0;
  double u = 0.0;           // standard uncertainty
  double sensitivity = 1.0; // c_i = d result / d input
  Distribution distribution = Distribution::normal;
  double degrees_of_freedom = infinite_degrees_of_freedom;
};

struct InputCorrelation {
  std::size_t first = 0;
  std::size_t second = 0;
  double coefficient = 0.0;
};

struct PropagatedUncertainty {
  double u = 0.0;
  double degrees_of_freedom = infinite_degrees_of_freedom;
  double k = 2.0;                    // at 95.45 %
  double expanded = 0.0;             // k u
  std::vector<double> contributions; // c_i u_i
};

[[nodiscard]] Expected<PropagatedUncertainty>
propagate_uncertainty(std::span<const InputQuantity> inputs,
                      std::span<const InputCorrelation> correlations = {});

} // namespace dyncal::analysis
