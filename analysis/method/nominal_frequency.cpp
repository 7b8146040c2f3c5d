#include "analysis/method/nominal_frequency.hpp"

#include <cmath>

namespace dyncal::analysis {

Expected<NominalFrequency> real_rate_from_apparent_frequency(double nominal_rate_hz,
                                                             double applied_hz, double u_applied_hz,
                                                             double apparent_hz,
                                                             double u_apparent_hz) {
  if (!(nominal_rate_hz > 0.0) || !(applied_hz > 0.0) || !(apparent_hz > 0.0)) {
    return fail(ErrorCode::invalid_argument,
                "nominal rate, applied and apparent frequency must be positive");
  }
  NominalFrequency result;
  result.apparent_hz = apparent_hz;
  result.u_apparent_hz = u_apparent_hz;
  result.lambda = applied_hz / apparent_hz;
  const double u_rel = std::hypot(u_applied_hz / applied_hz, u_apparent_hz / apparent_hz);
  result.u_lambda = result.lambda * u_rel;
  result.real_rate_hz = nominal_rate_hz * result.lambda;
  result.u_real_rate_hz = result.real_rate_hz * u_rel;
  return result;
}

} // namespace dyncal::analysis
