// The results of a run as JSON, with the members and every digit of result files
// (services/views/report/result_json.hpp) as far as the bus carries them. Plain functions; the
// thread of the laboratory.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/network/run.hpp"

namespace dyncal::services::live {

// Points, transfer functions and sample clocks.
[[nodiscard]] nlohmann::ordered_json run_json(const Run& run);
[[nodiscard]] nlohmann::ordered_json point_json(const StepResult& result);
[[nodiscard]] nlohmann::ordered_json flags_json(const std::vector<Flag>& flags);

} // namespace dyncal::services::live
