#include "analysis/response/comparison.hpp"

#include <cmath>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {

Expected<double> normalised_error(double x, double u_x, double y, double u_y, double covariance) {
  const double variance = u_x * u_x + u_y * u_y - 2.0 * covariance;
  if (!(u_x >= 0.0) || !(u_y >= 0.0) || !(variance > 0.0) || !std::isfinite(x - y)) {
    return fail(
        ErrorCode::invalid_argument,
        "the uncertainties of both results must be positive, and the covariance below them");
  }
  return (x - y) / (2.0 * std::sqrt(variance));
}

Expected<ComplexComparison> compare_transfer(const ComparedResult& x, const ComparedResult& y,
                                             const SharedUncertainty& shared) {
  DYNCAL_TRY(
      const auto magnitude,
      normalised_error(x.magnitude, x.u_magnitude, y.magnitude, y.u_magnitude,
                       shared.magnitude_rel * shared.magnitude_rel * x.magnitude * y.magnitude));
  DYNCAL_TRY(const auto phase,
             normalised_error(wrap_phase(x.phase_rad - y.phase_rad), x.u_phase_rad, 0.0,
                              y.u_phase_rad, shared.phase_rad * shared.phase_rad));
  const double chi_squared = 4.0 * (magnitude * magnitude + phase * phase);
  return ComplexComparison{magnitude, phase, chi_squared, std::exp(-0.5 * chi_squared)};
}

} // namespace dyncal::analysis
