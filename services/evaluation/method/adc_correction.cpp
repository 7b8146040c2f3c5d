#include "services/evaluation/method/adc_correction.hpp"

#include <algorithm>
#include <numbers>

namespace dyncal::services {

analysis::Expected<analysis::AdcResponse> adc_response(const SampleStampingRoles& roles,
                                                       const RecipeStep& step) {
  if (roles.adc_calibration.empty()) {
    return analysis::AdcResponse{};
  }
  return analysis::adc_response_at(roles.adc_calibration, step.frequency.hz());
}

double u_adc_delay_s(const SampleStampingRoles& roles, std::span<const double> frequencies_hz) {
  double max_s = 0.0;
  for (const double frequency_hz : frequencies_hz) {
    if (const auto adc = analysis::adc_response_at(roles.adc_calibration, frequency_hz)) {
      max_s = std::max(max_s, adc->u_phase_lag_rad / (2.0 * std::numbers::pi * frequency_hz));
    }
  }
  return max_s;
}

} // namespace dyncal::services
