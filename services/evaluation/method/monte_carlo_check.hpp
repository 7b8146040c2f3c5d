// The Monte Carlo cross-check of one result (JCGM 101): the uncertainty that drawing from the
// budget gives, beside the one that the budget gives itself.
//
// Both agree for a sound result; where they do not (|H| near 0, little excitation), the interval is
// the better answer. Where the check itself fails (analysis/method/transfer_check.hpp), a flag
// gives the reason. Asked to stop, it fails within some milliseconds. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "analysis/method/transfer_point.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// Nothing for 0 trials. The seed is fixed, so that the same samples give the same bits. `link` as
// analysis::check_transfer() takes it.
void add_monte_carlo_check(std::uint64_t max_trials, const analysis::TransferPoint& point,
                           std::span<const analysis::ChannelFit> link, const std::stop_token& stop,
                           StepResult& result);

// Again for a result that had a check and has another budget now.
void redo_monte_carlo_check(std::uint64_t max_trials, const std::stop_token& stop,
                            StepResult& result);

} // namespace dyncal::inline evaluation
