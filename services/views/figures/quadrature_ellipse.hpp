// The two signals of a laser interferometer as a picture: on the left the ellipse on which they
// lie, and the circle that the correction makes of it; on the right what the correction leaves, as
// an error of the displacement over the phase.
//
//   raw        u1 = p + R cos(phi), u2 = q + (R / r) sin(phi - alpha)
//   corrected  X = R cos(phi), Y = R sin(phi)
//   remains    +- u of the ellipse as a band; for the orders k = 1..4 the amplitude e_k that is
//              stated, as e_k sin(k phi): how the orders lie to each other is not known
//   measured   (rho - rho_0) / rho_0 of the corrected radius, in parts of the turn, as dots: what
//              is left of the signals themselves. A radius that changes goes with a phase error of
//              the same order and amplitude, a quarter of a period of it aside
//
// Errors are in nm: e of a turn of the displacement. The CSV holds the curves.
#pragma once

#include <string>
#include <vector>

#include "analysis/interferometer/ellipse.hpp"
#include "services/views/figures/figure.hpp"

namespace dyncal::inline views::figures {

struct QuadratureEllipseData {
  PictureTitle title{};
  analysis::Ellipse ellipse{};
  double displacement_per_turn_m = 0.0;
  std::vector<double> u_ellipse_rad{};      // orders 1 and 2; empty: not stated
  std::vector<double> periodic_error_rad{}; // orders 1 to 4, amplitudes; empty: not stated
  // In equal parts of the turn from phase 0 on; empty: not measured.
  std::vector<double> radius_deviation_rel{};
  std::string below{}; // a paragraph; may be empty
};

[[nodiscard]] Figure quadrature_ellipse_figure(const QuadratureEllipseData& data,
                                               const std::string& name);

} // namespace dyncal::inline views::figures
