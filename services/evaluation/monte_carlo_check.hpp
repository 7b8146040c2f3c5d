// The Monte Carlo cross-check of one result (JCGM 101) as the contract publishes it: the
// uncertainty that the budget gives beside the one that drawing from it gives. Both agree for a
// sound result; where they do not (|H| near 0, little excitation), the interval is the better
// answer. Where the check itself fails (analysis/method/transfer_check.hpp), a flag says so. Any
// thread.
#pragma once

#include <span>

#include "analysis/method/transfer_point.hpp"
#include "idl/dyncal.h"
#include "services/evaluation/recipe.hpp"

namespace dyncal::services {

// Nothing when the recipe asks for no check. The seed is fixed, so that the same samples give the
// same bits. `link` as analysis::check_transfer() takes it.
void add_monte_carlo_check(const Recipe& recipe, const analysis::TransferPoint& point,
                           std::span<const analysis::ChannelFit> link,
                           wire::CalibrationResult& result);

} // namespace dyncal::services
