#include "services/evaluation/monte_carlo_check.hpp"

#include "analysis/monte_carlo.hpp"

namespace dyncal::services {

Expected<MonteCarloCheck> monte_carlo_check(const analysis::SampleStampingInput& input, const analysis::SampleStampingResult& result,
                                            std::size_t point, std::uint64_t trials) {
  const auto drawn = analysis::check_sample_stamping(input, result, point, {.most_trials = trials});
  if (!drawn) {
    return tl::unexpected(Error{ErrorCode::bad_argument, drawn.error().message});
  }
  MonteCarloCheck check;
  check.trials(drawn->magnitude.trials);
  check.stable(drawn->magnitude.stable && drawn->phase_rad.stable);
  check.u_magnitude(drawn->magnitude.u);
  check.magnitude_low(drawn->magnitude.low);
  check.magnitude_high(drawn->magnitude.high);
  check.u_phase_rad(drawn->phase_rad.u);
  check.phase_low_rad(drawn->phase_rad.low);
  check.phase_high_rad(drawn->phase_rad.high);
  return check;
}

} // namespace dyncal::services
