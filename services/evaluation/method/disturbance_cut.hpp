// Knocks (analysis/step/short_disturbance.hpp) are cut out of the samples of a step before its
// value is stated: it is evaluated once more without them, and a flag says so.
//
// All channels of the source lose these samples, for they share their stamps. Any thread.
#pragma once

#include <functional>
#include <initializer_list>

#include "analysis/base/error.hpp"
#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {

// `evaluate` is called anew where samples of `parts` were left out. Flags go to the task.
[[nodiscard]] analysis::Expected<EvaluatedStep>
evaluate_without_knocks(StepTask& task, std::initializer_list<SelectedChannels*> parts,
                        const std::function<analysis::Expected<EvaluatedStep>()>& evaluate);

} // namespace dyncal::inline evaluation
