#include "analysis/uncertainty/quantisation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::analysis {

QuantisationUncertainty quantisation_uncertainty(double amplitude, double residual_sd,
                                                 double resolution, double samples_per_period) {
  if (!(resolution > 0.0)) {
    return {};
  }
  const double own_variance = resolution * resolution / 12.0;
  const double dither =
      std::sqrt(std::max(0.0, residual_sd * residual_sd - own_variance)) / resolution;
  if (dither >= 0.5) {
    return {};
  }
  const double damping = std::exp(-2.0 * std::numbers::pi * std::numbers::pi * dither * dither);
  const double steps = amplitude / resolution;
  const double bound = steps > 0.0 ? std::min(2.0 / std::numbers::pi, 0.53 / std::sqrt(steps))
                                   : 2.0 / std::numbers::pi;
  QuantisationUncertainty result;
  result.u_amplitude = resolution * bound * damping / std::sqrt(3.0);
  if (amplitude > 0.0) {
    result.u_phase_rad =
        std::sqrt(own_variance * 2.0 / std::max(1.0, samples_per_period)) / amplitude * damping;
  }
  return result;
}

} // namespace dyncal::analysis
