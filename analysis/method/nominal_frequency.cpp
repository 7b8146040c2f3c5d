#include "analysis/method/nominal_frequency.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "analysis/sine/equidistant_axis.hpp"
#include "analysis/sine/sine_fit.hpp"

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

Expected<NominalFrequency> evaluate_nominal_frequency(double nominal_rate_hz,
                                                      const Frequency& applied, double u_applied_hz,
                                                      std::span<const double> samples,
                                                      double rate_tolerance_rel) {
  if (!(nominal_rate_hz > 0.0)) {
    return fail(ErrorCode::invalid_argument, "the nominal sample rate must be positive");
  }
  const EquidistantAxis axis(1.0 / nominal_rate_hz);
  const std::vector<std::int64_t> stamps_ns = axis.stamps_ns(samples.size());
  const std::array channels{samples};
  const std::int64_t middle_ns = stamps_ns.empty() ? 0 : stamps_ns.back() / 2;
  const auto fit = fit_sine_and_frequency(axis.on_axis(applied.hz()), rate_tolerance_rel, middle_ns,
                                          stamps_ns, channels);
  if (!fit) {
    return fail(fit.error());
  }
  return real_rate_from_apparent_frequency(nominal_rate_hz, applied.hz(), u_applied_hz,
                                           axis.hz(fit->frequency.hz()),
                                           axis.hz(fit->u_frequency_hz));
}

} // namespace dyncal::analysis
