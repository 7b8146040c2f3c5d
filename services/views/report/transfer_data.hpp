// What the figures of a run draw of one channel: from the transfer function of a run that is over,
// or from the results of one that lasts. Files and the page take it from here, so that the same
// results give the same picture.
//
// Means are those of the transfer function, with u and U. While the run lasts there is none: means
// are then plain ones over the valid repetitions of each frequency and level, with phases in one
// turn, continuous over frequency, and repetitions have u and U. Any thread.
#pragma once

#include <string>

#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/figures/transfer_function.hpp"

namespace dyncal::inline views {

[[nodiscard]] figures::RepetitionPoint repetition_of(const StepResult& result,
                                                     const std::string& flag_names);
[[nodiscard]] figures::TransferFunctionData transfer_data(const RunOutcome& outcome,
                                                          const TransferFunction& function);
[[nodiscard]] figures::TransferFunctionData transfer_data_so_far(const RunOutcome& outcome,
                                                                 const std::string& channel);

} // namespace dyncal::inline views
