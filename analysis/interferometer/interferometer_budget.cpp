#include "analysis/interferometer/interferometer_budget.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::analysis {
namespace {

// Periodic errors of the phase as variances of amplitude, and so of their effect on a magnitude.
double periodic_variance(double mean_square_error_rad, int order, double phase_amplitude_rad) {
  const double change = largest_periodic_change(1.0, order, phase_amplitude_rad);
  return mean_square_error_rad * change * change / 2.0;
}

// Sum of the variances of cosine and sine of the phase error of orders 1 and 2. By the model's
// derivatives: dp and r dq move the centre, dr / r and dalpha squeeze the circle by half of it.
double ellipse_variance(const EllipseFit& fit, double phase_amplitude_rad) {
  const auto& v = fit.covariance;
  const Ellipse& e = fit.ellipse;
  const double square = e.radius * e.radius;
  const double first = (v[0][0] + e.r * e.r * v[1][1]) / square;
  const double second = (v[2][2] / (e.r * e.r) + v[3][3]) / 4.0;
  return periodic_variance(first, 1, phase_amplitude_rad) +
         periodic_variance(second, 2, phase_amplitude_rad);
}

double residual_variance(const RadiusHarmonics& radius, double phase_amplitude_rad) {
  double variance = 0.0;
  for (std::size_t i = 0; i < radius_orders; ++i) {
    const double error_rad = radius.amplitude[i] / radius.mean;
    variance +=
        periodic_variance(error_rad * error_rad, static_cast<int>(i) + 1, phase_amplitude_rad);
  }
  return variance;
}

InterferometerRow periodic_row(std::string_view name, Distribution distribution, double variance,
                               double periods) {
  const double u = std::sqrt(variance);
  const double of_ends = 1.0 / std::max(1.0, std::numbers::pi * periods);
  return {name, distribution, Repeats::common, infinite_degrees_of_freedom, u, u * of_ends};
}

InterferometerRow bandwidth_row(double frequency_hz, double bandwidth_hz) {
  const double ratio = frequency_hz / bandwidth_hz;
  return {"bandwidth of the detectors",
          Distribution::rectangular,
          Repeats::common,
          infinite_degrees_of_freedom,
          ratio * ratio / 2.0 / std::sqrt(3.0),
          ratio / std::sqrt(3.0)};
}

} // namespace

double largest_periodic_change(double error_rad, int order, double phase_amplitude_rad) {
  return 2.0 * error_rad * std::abs(std::cyl_bessel_j(1.0, order * phase_amplitude_rad)) /
         phase_amplitude_rad;
}

Expected<std::vector<InterferometerRow>> interferometer_rows(const InterferometerStep& step,
                                                             const RecordEllipse& ellipse,
                                                             const AirWavelength& wavelength,
                                                             const DetectorSettings& detectors,
                                                             const SineFit& acceleration) {
  if (!(step.frequency_hz > 0.0) || !(step.phase_amplitude_rad > 0.0) || !(step.periods > 0.0)) {
    return fail(ErrorCode::invalid_argument,
                "frequency, phase amplitude and periods of an interferometer's step must be given");
  }
  if (!ellipse.radius) {
    return fail(ErrorCode::ill_conditioned,
                "the ellipse of the interferometer comes from a record of less than one turn, "
                "which does not show its residual periodic error. Use the ellipse of a step that "
                "covers a turn, or of a file");
  }
  const double m = step.phase_amplitude_rad;
  const double w = 2.0 * std::numbers::pi * step.frequency_hz;
  std::vector<InterferometerRow> rows;
  rows.push_back(periodic_row("ellipse of the interferometer", Distribution::normal,
                              ellipse_variance(ellipse.fit, m), step.periods));
  rows.push_back(periodic_row("periodic error of the interferometer", Distribution::arcsine,
                              residual_variance(*ellipse.radius, m), step.periods));
  rows.push_back({"wavelength in air", Distribution::normal, Repeats::common,
                  infinite_degrees_of_freedom, wavelength.u_rel, 0.0});
  if (detectors.bandwidth_hz) {
    rows.push_back(bandwidth_row(step.frequency_hz, *detectors.bandwidth_hz));
  }
  rows.push_back({"skew of the detectors", Distribution::normal, Repeats::common,
                  infinite_degrees_of_freedom, 0.0, w * detectors.u_skew_s / 2.0});
  rows.push_back({"noise of the interferometer", Distribution::normal, Repeats::anew,
                  acceleration.degrees_of_freedom,
                  step.noise_factor * acceleration.u_amplitude() / acceleration.amplitude(),
                  step.noise_factor * acceleration.u_phase_rad()});
  return rows;
}

} // namespace dyncal::analysis
