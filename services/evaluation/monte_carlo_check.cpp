#include "services/evaluation/monte_carlo_check.hpp"

#include "analysis/method/transfer_check.hpp"

namespace dyncal::services {

void add_monte_carlo_check(const Recipe& recipe, const analysis::TransferPoint& point,
                           std::span<const analysis::ChannelFit> link,
                           wire::CalibrationResult& result) {
  if (recipe.monte_carlo_trials == 0) {
    return;
  }
  const auto drawn =
      analysis::check_transfer(point, link, {.max_trials = recipe.monte_carlo_trials});
  if (!drawn) {
    result.flags().push_back("no Monte Carlo check: " + drawn.error().message);
    return;
  }
  wire::MonteCarloCheck check;
  check.trials(drawn->magnitude.trials);
  check.stable(drawn->magnitude.stable && drawn->phase_rad.stable);
  check.u_magnitude(drawn->magnitude.u);
  check.magnitude_low(drawn->magnitude.low);
  check.magnitude_high(drawn->magnitude.high);
  check.u_phase_rad(drawn->phase_rad.u);
  check.phase_low_rad(drawn->phase_rad.low);
  check.phase_high_rad(drawn->phase_rad.high);
  result.monte_carlo().push_back(check);
}

} // namespace dyncal::services
