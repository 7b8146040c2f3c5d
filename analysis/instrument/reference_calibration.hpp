// The response of the reference transducer at a frequency and level, from the points of its
// calibration certificate.
//
//   R = magnitude e^{i phase_rad}     what its channel reads over what is; phase is lead, (-pi, pi]
//
// so that H of a sensor, measured against the reading, is multiplied by R. Its uncertainty is a
// list of contributions (ISO 16063-11 annex A has them: distortion, hum, transverse motion, base
// strain, temperature, mounting, drift), uncorrelated with each other; every point has them all, in
// one order. An unnamed one is what the others leave of the whole.
//
// Magnitude and unwrapped phase are interpolated over frequency (curve_between_points.hpp), then
// linearly in level between curves of one level each; points that all have the same level hold at
// every level. A contribution is w1 u1 + w2 u2: the points of a certificate have it in common. What
// a straight line misses between two frequencies is a contribution of its own, "interpolation",
// rectangular. Degrees of freedom are the fewest of the points.
//
// Fails: invalid_argument (no points, not positive or not finite, contributions differ from point
// to point, a point twice), out_of_calibration: nothing is extrapolated. Any thread.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

struct ReferenceContribution {
  std::string name{}; // empty: what the named ones leave of the whole
  Distribution distribution = Distribution::normal;
  double u_magnitude_rel = 0.0;
  double u_phase_rad = 0.0;
  double degrees_of_freedom = infinite_degrees_of_freedom;
};

struct ReferenceCalibrationPoint {
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  double magnitude = 1.0;
  double phase_rad = 0.0;
  std::vector<ReferenceContribution> contributions{};
};

struct ReferenceResponse {
  double magnitude = 1.0;
  double phase_rad = 0.0;
  std::vector<ReferenceContribution> contributions{};

  [[nodiscard]] std::complex<double> phasor() const { return std::polar(magnitude, phase_rad); }
};

[[nodiscard]] Expected<ReferenceResponse>
reference_response_at(std::span<const ReferenceCalibrationPoint> points, double frequency_hz,
                      double level_m_s2);

} // namespace dyncal::analysis
