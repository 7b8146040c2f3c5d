// What an interferometer adds to the uncertainty of a reference amplitude and phase, row by row.
//
// A periodic error of the phase, e cos(k phi + psi), of a motion phi = phi_0 + M sin(w t) has at
// the frequency of the step
//
//   dA / A = (2 e J1(k M) / M) sin(k phi_0 + psi)   at most 2 e |J1(k M)| / M
//
// M = 4 pi N s / lambda is the phase amplitude in radians. The working point phi_0 is not known and
// drifts: over its turn the error has an arcsine distribution, u = 2 e |J1(k M)| / (M sqrt(2)). It
// has no part in quadrature as long as phi_0 rests or drifts in a straight line by less than a turn
// a period; u of the phase is what the ends of the record leave, u / (pi periods).
//
//   ellipse          k = 1 from the covariance of p, q; k = 2 from that of r, alpha
//   periodic error   k = 1..4, e_k = rho_k / R of the radius that the ellipse leaves
//   wavelength       relative, of the amplitude alone
//   bandwidth        one pole at f_c delays the phase by 0 to 1 / (2 pi f_c), less the faster the
//                    fringes are, and takes up to (f / f_c)^2 / 2 off the amplitude. Neither is
//                    corrected: half-widths of rectangular distributions
//   skew             of the two channels: w dt / 2 in phase, up to w dt on arcs below a fringe
//
// The noise is that of the sine fit. Plain functions, any thread.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/interferometer/air_wavelength.hpp"
#include "analysis/interferometer/record_ellipse.hpp"
#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

// What the ellipse leaves of the phase, in radians, orders 1 and 2: standard uncertainties; and by
// how much the phases of two ellipses differ.
using EllipseErrors = std::array<double, 2>;
[[nodiscard]] EllipseErrors ellipse_errors(const EllipseFit& fit);
[[nodiscard]] EllipseErrors ellipse_difference(const Ellipse& one, const Ellipse& other);

struct DetectorSettings {
  std::optional<double> bandwidth_hz; // of the slower one; empty: fast enough not to matter
  double u_skew_s = 0.0;              // of the delay of u2 after u1
};

// Of a displacement that was made of quadrature signals, whatever the step.
struct InterferometerErrors {
  double displacement_per_turn_m = 0.0;
  EllipseErrors ellipse_rad{};                      // orders 1 and 2: standard uncertainty
  std::array<double, radius_orders> periodic_rad{}; // e_k: amplitude
  double u_wavelength_rel = 0.0;
  DetectorSettings detectors;
};

// Fails (ill_conditioned) where the ellipse came from a record that covers less than a turn: then
// nobody knows the residual periodic error.
[[nodiscard]] Expected<InterferometerErrors>
interferometer_errors(const RecordEllipse& ellipse, double displacement_per_turn_m,
                      const AirWavelength& wavelength, const DetectorSettings& detectors);

struct InterferometerStep {
  double frequency_hz = 0.0;
  double displacement_m = 0.0; // amplitude
  double periods = 0.0;        // in the record
};

// Largest relative change of an amplitude by a periodic error of order k. REQUIRES: M > 0.
[[nodiscard]] double largest_periodic_change(double error_rad, int order,
                                             double phase_amplitude_rad);

// REQUIRES: a frequency, an amplitude, a displacement per turn.
[[nodiscard]] std::vector<Contribution> interferometer_rows(const InterferometerStep& step,
                                                            const InterferometerErrors& errors);

} // namespace dyncal::analysis
