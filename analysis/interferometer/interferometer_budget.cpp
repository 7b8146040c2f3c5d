#include "analysis/interferometer/interferometer_budget.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::analysis {
namespace {

template <std::size_t orders>
Contribution periodic_row(ContributionKind kind, Distribution distribution,
                          const std::array<double, orders>& error_rad, double phase_amplitude_rad,
                          double periods) {
  double variance = 0.0;
  for (std::size_t i = 0; i < orders; ++i) {
    const double change =
        largest_periodic_change(error_rad[i], static_cast<int>(i) + 1, phase_amplitude_rad);
    variance += change * change / 2.0;
  }
  const double u = std::sqrt(variance);
  return {.kind = kind,
          .distribution = distribution,
          .u_magnitude_rel = u,
          .u_phase_rad = u / std::max(1.0, std::numbers::pi * periods)};
}

Contribution bandwidth_row(double frequency_hz, double bandwidth_hz) {
  const double ratio = frequency_hz / bandwidth_hz;
  return {.kind = ContributionKind::detector_bandwidth,
          .distribution = Distribution::rectangular,
          .u_magnitude_rel = ratio * ratio / 2.0 / std::sqrt(3.0),
          .u_phase_rad = ratio / std::sqrt(3.0)};
}

} // namespace

// By the model's derivatives: dp and r dq move the centre, dr / r and dalpha squeeze the circle by
// half of it. Variances of cosine and sine of the error, in sum.
EllipseErrors ellipse_errors(const EllipseFit& fit) {
  const auto& v = fit.covariance;
  const Ellipse& e = fit.ellipse;
  const double square = e.radius * e.radius;
  return {std::sqrt((v[0][0] + e.r * e.r * v[1][1]) / square),
          std::sqrt((v[2][2] / (e.r * e.r) + v[3][3]) / 4.0)};
}

EllipseErrors ellipse_difference(const Ellipse& one, const Ellipse& other) {
  return {std::hypot(one.p - other.p, one.r * (one.q - other.q)) / one.radius,
          std::hypot(one.r / other.r - 1.0, one.alpha_rad - other.alpha_rad) / 2.0};
}

double largest_periodic_change(double error_rad, int order, double phase_amplitude_rad) {
  return 2.0 * error_rad * std::abs(std::cyl_bessel_j(1.0, order * phase_amplitude_rad)) /
         phase_amplitude_rad;
}

Expected<InterferometerErrors> interferometer_errors(const RecordEllipse& ellipse,
                                                     double displacement_per_turn_m,
                                                     const AirWavelength& wavelength,
                                                     const DetectorSettings& detectors) {
  if (!ellipse.radius) {
    return fail(ErrorCode::ill_conditioned,
                "the ellipse of the interferometer comes from a record of less than one turn, "
                "which does not show its residual periodic error. Use the ellipse of a step that "
                "covers a turn, or of a file");
  }
  InterferometerErrors errors{.displacement_per_turn_m = displacement_per_turn_m,
                              .ellipse_rad = ellipse_errors(ellipse.fit),
                              .u_wavelength_rel = wavelength.u_rel,
                              .detectors = detectors};
  for (std::size_t i = 0; i < radius_orders; ++i) {
    errors.periodic_rad[i] = ellipse.radius->amplitude[i] / ellipse.radius->mean;
  }
  return errors;
}

std::vector<Contribution> interferometer_rows(const InterferometerStep& step,
                                              const InterferometerErrors& errors) {
  const double turn_m = std::abs(errors.displacement_per_turn_m);
  const double m = 2.0 * std::numbers::pi * step.displacement_m / turn_m;
  const double w = 2.0 * std::numbers::pi * step.frequency_hz;
  const double of_skew = m > 2.0 * std::numbers::pi ? 0.5 : 1.0;
  std::vector<Contribution> rows{
      periodic_row(ContributionKind::interferometer_ellipse, Distribution::normal,
                   errors.ellipse_rad, m, step.periods),
      periodic_row(ContributionKind::periodic_error, Distribution::arcsine, errors.periodic_rad, m,
                   step.periods),
      {.kind = ContributionKind::wavelength, .u_magnitude_rel = errors.u_wavelength_rel},
      {.kind = ContributionKind::detector_skew,
       .u_phase_rad = of_skew * w * errors.detectors.u_skew_s}};
  if (errors.detectors.bandwidth_hz) {
    rows.push_back(bandwidth_row(step.frequency_hz, *errors.detectors.bandwidth_hz));
  }
  return rows;
}

} // namespace dyncal::analysis
