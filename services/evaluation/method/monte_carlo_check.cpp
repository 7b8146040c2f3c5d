#include "services/evaluation/method/monte_carlo_check.hpp"

#include "analysis/method/transfer_check.hpp"

namespace dyncal::inline evaluation {

void add_monte_carlo_check(std::uint64_t max_trials, const analysis::TransferPoint& point,
                           std::span<const analysis::ChannelFit> link, const std::stop_token& stop,
                           StepResult& result) {
  if (max_trials == 0) {
    return;
  }
  auto drawn = analysis::check_transfer(point, link, {.max_trials = max_trials, .stop = stop});
  if (!drawn) {
    result.flags.push_back(
        flag_with_reason(ResultFlag::no_monte_carlo_check, drawn.error().message));
    return;
  }
  result.monte_carlo = *drawn;
}

void redo_monte_carlo_check(std::uint64_t max_trials, const std::stop_token& stop,
                            StepResult& result) {
  if (!result.monte_carlo) {
    return;
  }
  result.monte_carlo.reset();
  const std::span<const analysis::ChannelFit> fits(result.fits); // that of the sensor is the last
  add_monte_carlo_check(max_trials,
                        {.channel = result.channel,
                         .h = std::polar(result.magnitude, result.phase_rad),
                         .magnitude = result.magnitude,
                         .u_magnitude = result.u_magnitude,
                         .phase_rad = result.phase_rad,
                         .u_phase_rad = result.u_phase_rad,
                         .budget = result.budget,
                         .dut = fits.back()},
                        fits.first(fits.size() - 1), stop, result);
}

} // namespace dyncal::inline evaluation
