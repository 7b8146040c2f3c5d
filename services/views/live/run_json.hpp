// The results of a run as the page gets them: as its result file has them
// (services/views/report/result_json.hpp) as far as the bus carries them, and beside the numbers
// the texts that the page shows. Plain functions; the thread of the laboratory.
//
// Without what the page asks for by itself or does not show: budgets, fits, samples by source.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "services/network/run.hpp"

namespace dyncal::inline views::live {

[[nodiscard]] nlohmann::ordered_json run_json(const std::string& bench, const network::Run& run);

} // namespace dyncal::inline views::live
