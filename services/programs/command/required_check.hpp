// Whether a run may begin on a bench that demands a check: the newest complete result of the check
// sensor on this bench in the store is young enough, and its control chart does not say "action"
// (services/records/store/control_chart.hpp). A warning, and too few results for limits, do not
// stop a run; its result says so. A run of the check sensor itself needs none.
//
// Fails (no_result) with what is wrong and what to do. Any thread.
#pragma once

#include <cstdint>
#include <string>

#include "services/base/error.hpp"
#include "services/bench/file/check_table.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/daily_check.hpp"

namespace dyncal::inline programs {

struct CheckDemand {
  CheckSettings settings;
  std::string store;    // its place; empty: there is none
  std::string left_out; // why the run is to begin without; empty: it is not
};

// `planned`: the run, whose sources have described themselves.
[[nodiscard]] Expected<DailyCheck>
require_check(const CheckDemand& demand, const RunOutcome& planned, std::int64_t now_utc_ns);

} // namespace dyncal::inline programs
