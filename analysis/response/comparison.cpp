#include "analysis/response/comparison.hpp"

#include <array>
#include <cmath>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {

Expected<Difference> difference_of(double x, const CombinedUncertainty& of_x, double y,
                                   const CombinedUncertainty& of_y, double covariance) {
  const double expanded2 =
      std::pow(of_x.expanded(), 2) + std::pow(of_y.expanded(), 2) - 8.0 * covariance;
  const double variance = of_x.u * of_x.u + of_y.u * of_y.u - 2.0 * covariance;
  if (!(of_x.u >= 0.0) || !(of_y.u >= 0.0) || !(variance > 0.0) || !(expanded2 > 0.0) ||
      !std::isfinite(x - y)) {
    return fail(
        ErrorCode::invalid_argument,
        "the uncertainties of both results must be positive, and the covariance below them");
  }
  const std::array parts{UncertaintyPart{of_x.u, of_x.degrees_of_freedom},
                         UncertaintyPart{of_y.u, of_y.degrees_of_freedom}};
  const double u = std::sqrt(variance);
  return Difference{x - y, {u, effective_degrees_of_freedom(parts), std::sqrt(expanded2) / u}};
}

Expected<ComplexComparison> compare_transfer(const ComparedResult& x, const ComparedResult& y,
                                             const SharedUncertainty& shared) {
  DYNCAL_TRY(
      const auto magnitude,
      difference_of(x.magnitude, x.of_magnitude, y.magnitude, y.of_magnitude,
                    shared.magnitude_rel * shared.magnitude_rel * x.magnitude * y.magnitude));
  DYNCAL_TRY(const auto phase, difference_of(wrap_phase(x.phase_rad - y.phase_rad), x.of_phase, 0.0,
                                             y.of_phase, shared.phase_rad * shared.phase_rad));
  const double chi_squared =
      4.0 * (std::pow(magnitude.normalised_error(), 2) + std::pow(phase.normalised_error(), 2));
  return ComplexComparison{magnitude, phase, chi_squared, std::exp(-0.5 * chi_squared)};
}

} // namespace dyncal::analysis
