// The results of a run as the page gets them: as its result file has them
// (services/views/report/result_json.hpp) as far as the bus carries them, and beside the numbers
// the texts that the page shows. Plain functions; the thread of the laboratory.
//
// Without what the page asks for by itself or does not show: budgets, fits, samples by source.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/network/bench.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views::live {

// What a result file of the run would have of it.
[[nodiscard]] StoredResult heard_result(const network::Bench& bench, const network::Run& run);

[[nodiscard]] nlohmann::ordered_json run_json(const network::Bench& bench, const network::Run& run);

} // namespace dyncal::inline views::live
