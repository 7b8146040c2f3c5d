// Several runs of one sensor, mounted anew for each of them, as one: a result for each mounting and
// point, so that the mean over mountings has their scatter in its uncertainty.
//
// Of each run the mean over its repetitions (mean_points.hpp) becomes one result. What is drawn
// anew in every repetition is one row of its budget, as small as the repetitions have made it; rows
// that are the same in all repetitions stay as they are, for the reference and the instruments are
// those of all mountings: they do not average. The mean over mountings then finds what mountings
// differ by from all frequencies together, as it does for repetitions
// (analysis/method/repetitions.hpp).
//
// Plain functions; any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

// `results` of one run, of any channels, the valid ones of which count; their repetition in what is
// returned is `mounting`, from 1. Flags are not carried over.
[[nodiscard]] std::vector<StepResult> mounting_results(const std::vector<StepResult>& results,
                                                       std::uint32_t mounting);

// Channel by channel, of the results of all mountings: points that all of them have.
[[nodiscard]] std::vector<TransferFunction>
combined_functions(const std::vector<StepResult>& results, std::uint32_t mountings);

} // namespace dyncal::inline evaluation
