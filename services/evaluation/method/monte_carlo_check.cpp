#include "services/evaluation/method/monte_carlo_check.hpp"

#include "analysis/method/transfer_check.hpp"

namespace dyncal::services {

void add_monte_carlo_check(std::uint64_t max_trials, const analysis::TransferPoint& point,
                           std::span<const analysis::ChannelFit> link, StepResult& result) {
  if (max_trials == 0) {
    return;
  }
  auto drawn = analysis::check_transfer(point, link, {.max_trials = max_trials});
  if (!drawn) {
    result.flags.push_back(
        flag_with_reason(ResultFlag::no_monte_carlo_check, drawn.error().message));
    return;
  }
  result.monte_carlo = *drawn;
}

} // namespace dyncal::services
