// What is known of the response of single channels under calibration (the amplifier of a sensor,
// say) is taken from their results.
//
//   H = H_read / R(f)       R: what the channel reads over what is (reference_calibration.hpp)
//
// The contributions of R are rows of the budget, called "response of the channel" or "response of
// the channel, NAME": relative in magnitude, and in phase. The response of the reference is part of
// each method (recipe.hpp).
//
// Plain functions, any thread.
#pragma once

#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// True for each result of the step that was changed.
[[nodiscard]] std::vector<bool> take_channel_responses(const Recipe& recipe,
                                                       std::vector<StepResult>& results);

} // namespace dyncal::inline evaluation
