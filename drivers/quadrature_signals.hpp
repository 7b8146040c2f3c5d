// What a source tells of a displacement that it makes of the two signals of a laser interferometer,
// so that whoever uses it knows its uncertainty.
//
//   u1 = p + R cos(phi) + n1,  u2 = q + (R/r) sin(phi - alpha) + n2   in the unit of the signals
//
// Errors are of the phase, in radians, by how often they repeat in a turn: those that the ellipse
// leaves (standard uncertainties, orders 1 and 2) and those that no ellipse corrects (amplitudes,
// orders 1 to 4); analysis/interferometer/interferometer_budget.hpp makes rows of them. Plain data;
// any thread.
#pragma once

#include <string>
#include <vector>

namespace dyncal::drivers {

struct QuadratureSignals {
  std::string channel; // the displacement
  double displacement_per_turn_m = 0.0;
  double u_wavelength_rel = 0.0;
  double centre_u1 = 0.0;            // p
  double centre_u2 = 0.0;            // q
  double radius_u1 = 0.0;            // R
  double radius_ratio = 1.0;         // r
  double quadrature_error_rad = 0.0; // alpha
  double turns_covered = 0.0;        // by the record that the ellipse is from
  std::string ellipse_from;          // in words
  std::vector<double> u_ellipse_rad;
  std::vector<double> periodic_error_rad;
  double detector_bandwidth_hz = 0.0; // 0: fast enough not to matter
  double u_skew_s = 0.0;
  // By how much the radius differs from its mean after the correction, in equal parts of the turn
  // from phase 0 on; empty: the phase has not gone round since the ellipse is in use.
  std::vector<double> radius_deviation_rel;
  bool operator==(const QuadratureSignals&) const = default;
};

} // namespace dyncal::drivers
