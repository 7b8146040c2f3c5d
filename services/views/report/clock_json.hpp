// The sample clock of a sensor for result files: statistics of its intervals, and every event with
// its place. Plain function, any thread.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/evaluation/result/clock_report.hpp"

namespace dyncal::services {

[[nodiscard]] nlohmann::ordered_json clock_json(const ClockReport& report);

} // namespace dyncal::services
