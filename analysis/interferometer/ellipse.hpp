// The ellipse on which the two signals of a quadrature interferometer lie, and how it is made a
// circle again (Heydemann, Appl. Opt. 20 (1981) 3382).
//
//   u1 = p + R cos(phi),   u2 = q + (R / r) sin(phi - alpha),   phi = 4 pi N s / lambda + phi_0
//   X = u1 - p,   Y = [r (u2 - q) + X sin(alpha)] / cos(alpha),   phi = atan2(Y, X)
//
// s is the displacement, N the number of passes (1: Michelson with a mirror, 2: double path). p, q
// and R are in the unit of the signals, counts or volts. Plain data, any thread.
#pragma once

#include <cmath>

#include "analysis/interferometer/kernel/quadrature_kernel.hpp"

namespace dyncal::analysis {

struct Ellipse {
  double p = 0.0;         // centre of u1
  double q = 0.0;         // centre of u2
  double r = 1.0;         // amplitude of u1 over that of u2
  double alpha_rad = 0.0; // by how much u2 lags behind quadrature
  double radius = 1.0;    // R, amplitude of u1
};

[[nodiscard]] inline kernel::QuadratureCorrection correction_of(const Ellipse& ellipse) {
  return {ellipse.p, ellipse.q, std::tan(ellipse.alpha_rad),
          ellipse.r / std::cos(ellipse.alpha_rad)};
}

} // namespace dyncal::analysis
