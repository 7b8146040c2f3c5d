// What a run leaves behind, as a table for people: digits follow the uncertainty (rounding.hpp),
// and every flag that occurs is explained at the end.
//
// Phase is lead, in rad, within (-pi, pi] (a delay is negative); u is a standard uncertainty (k =
// 1). Plain functions, any thread.
#pragma once

#include <string>

#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline views {

// The channel's magnitude is above three times its uncertainty at more than half of the
// frequencies: it is worth showing.
[[nodiscard]] bool responds(const TransferFunction& function);

// One row per channel and frequency; channels that do not respond are only named.
[[nodiscard]] std::string result_table(const RunOutcome& outcome);

} // namespace dyncal::inline views
