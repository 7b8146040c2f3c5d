// From combined standard uncertainty to coverage interval: Student's t, Welch-Satterthwaite (GUM
// G.4).
//
//   U = k u,   nu_eff = u^4 / sum(u_i^4 / nu_i)
//
// k(nu_eff) alone covers only 93 % where a part of two degrees of freedom stands beside a known one
// of 0.2..0.5 of it; expanding the parts one by one and adding squares covers up to 98 %. A third
// of the way between: 94.1..96.5 % for any known part.
//
// Degrees of freedom are positive real numbers; infinity is stated as such. Any thread.
#pragma once

#include <span>

#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

// Probability of |x| <= 2 sigma of a normal distribution.
inline constexpr double two_sigma_probability = 0.95449973610364158;

// Probability that Student's t with `degrees_of_freedom` is <= t.
[[nodiscard]] double student_probability(double t, double degrees_of_freedom);

// k so that |t| <= k with the given probability; 2 for infinite degrees of freedom, infinite where
// there are none.
[[nodiscard]] double coverage_factor(double degrees_of_freedom,
                                     double probability = two_sigma_probability);

struct UncertaintyPart {
  double u = 0.0;
  double degrees_of_freedom = infinite_degrees_of_freedom;
};

// nu_eff = u_c^4 / sum(u_i^4 / nu_i); infinite when all are.
[[nodiscard]] double effective_degrees_of_freedom(std::span<const UncertaintyPart> parts);

struct CombinedUncertainty {
  double u = 0.0;                                          // standard uncertainty, U / k
  double degrees_of_freedom = infinite_degrees_of_freedom; // nu_eff
  double k = 2.0;                                          // at 95.45 %

  [[nodiscard]] double expanded() const { return k * u; } // U
};

// Of independent parts.
[[nodiscard]] CombinedUncertainty combine(std::span<const UncertaintyPart> parts);

} // namespace dyncal::analysis
