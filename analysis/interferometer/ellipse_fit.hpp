// The ellipse of a quadrature interferometer from its moments, with the covariance of its
// parameters.
//
// Above one turn of phase, linear least squares (Heydemann): A x^2 + B xy + C y^2 + D x + E y = 1
// about the means. On shorter arcs noise bends that ellipse (0.5 rad of amplitude, 54 dB: 6 % of
// the displacement), so from 0.35 turns on the moments are adjusted for it first: x^2 - v,
// x^3 - 3 v x, x^4 - 6 v x^2 + 3 v^2, and so for y. v is the variance of white noise, the smaller
// one of what the fourth differences say (too much where the fringes are fast) and the radius of
// the linear ellipse (too much where the optics are not perfect).
//
// The covariance takes the distances from the ellipse for white noise; a radius that changes with
// the phase is the business of radius_over_phase.hpp.
//
// Refused (ill_conditioned), since a wrong ellipse shows nowhere else: less than 0.35 turns; points
// that lie on no ellipse; a radius outside 0.2 to 5 half ranges, r outside 0.4 to 2.5, alpha beyond
// 30 degrees, radii that scatter by more than 5 %; an ellipse that noise decides (adjusted and
// linear radius more than 5 % apart). The sentence says what to do. too_few_samples below 16,
// not_finite. Any thread.
#pragma once

#include <array>
#include <string_view>

#include "analysis/base/error.hpp"
#include "analysis/interferometer/ellipse.hpp"
#include "analysis/interferometer/ellipse_moments.hpp"

namespace dyncal::analysis {

inline constexpr double linear_ellipse_turns = 1.0;
inline constexpr double shortest_ellipse_turns = 0.35;

enum class EllipseMethod { linear, adjusted };

[[nodiscard]] std::string_view to_string(EllipseMethod method);

inline constexpr std::size_t ellipse_parameters = 5; // p, q, r, alpha, R

struct EllipseFit {
  Ellipse ellipse;
  EllipseMethod method = EllipseMethod::linear;
  std::array<std::array<double, ellipse_parameters>, ellipse_parameters> covariance{};
  double noise_sd_1 = 0.0; // of u1 and u2, in their unit
  double noise_sd_2 = 0.0;
  double radius_residual_sd = 0.0; // of sqrt(X^2 + Y^2), in the unit of u1
  double turns_covered = 0.0;
  double degrees_of_freedom = 0.0;
};

// By the one method or the other, whatever the arc. Refuses as above, but for the number of turns.
[[nodiscard]] Expected<EllipseFit> fit_ellipse_by(EllipseMethod method,
                                                  const EllipseMoments& moments);

// By the method that the turns ask for. These are the turns of phase between the extremes of the
// displacement, motion and drift: quadrature_phase.hpp counts them, record_ellipse.hpp does both.
[[nodiscard]] Expected<EllipseFit> fit_ellipse(const EllipseMoments& moments, double turns_covered);

} // namespace dyncal::analysis
