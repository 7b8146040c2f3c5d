// `dyncal analyse RECORDING`: the results of the live run from its recording, or from an export of
// it (services/records/exchange/opened_recording.hpp), or by another bench file. Belongs to one
// thread.
#pragma once

#include <stop_token>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/programs/command/analyse_command.hpp"

namespace dyncal::inline programs {

// Counts steps and results. Prints what is damaged or missing on standard error.
[[nodiscard]] Expected<RunOutcome> analyse_recording(const AnalyseCommand& command,
                                                     const std::stop_token& stop,
                                                     const SharedWorkCount& count);

} // namespace dyncal::inline programs
