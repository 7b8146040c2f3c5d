// What half of the steps of a channel show holds for all of them, also where the noise or a low
// frequency hides it: a clock that drifts in each series, stamps that are none of the samples.
//
// Where half of the steps with a value and at least two carry the flag, the others get it too, with
// a subject that counts them. Chance flags a step in less than one of 100, so that half of a run
// never are. Plain function, any thread.
#pragma once

#include <span>

#include "services/evaluation/result/result_flag.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// Returns whether it changed a result.
[[nodiscard]] bool add_flag_of_most(ResultFlag kind, std::span<StepResult> results);

} // namespace dyncal::inline evaluation
