// The contract's CalibrationResult: made from a result where it leaves, read where it comes in.
//
// What a member appended to the contract carries is missing in messages of older writers: then
// covariances of fitted coefficients are 0, flags have no name, and there is no temperature. Plain
// functions, any thread.
#pragma once

#include "idl/dyncal.h"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] wire::CalibrationResult to_message(const Recipe& recipe, const StepResult& result);
[[nodiscard]] StepResult from_message(const wire::CalibrationResult& message);

} // namespace dyncal::inline evaluation
