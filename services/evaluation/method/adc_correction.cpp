#include "services/evaluation/method/adc_correction.hpp"

namespace dyncal::inline evaluation {

analysis::Expected<analysis::AdcResponse> adc_response(const SampleStampingRoles& roles,
                                                       const RecipeStep& step) {
  if (roles.adc_calibration.empty()) {
    return analysis::AdcResponse{.u_phase_lag_rad = step.frequency.angular() * roles.u_adc_delay_s};
  }
  return analysis::adc_response_at(roles.adc_calibration, step.frequency.hz());
}

} // namespace dyncal::inline evaluation
