// The contract's CalibrationResult: made from a result where it leaves, read where it comes in.
//
// A message carries the standard uncertainties of fitted coefficients, not their covariances: these
// are 0 in what from_message() gives. Plain functions, any thread.
#pragma once

#include "idl/dyncal.h"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::services {

[[nodiscard]] wire::CalibrationResult to_message(const Recipe& recipe, const StepResult& result);
[[nodiscard]] StepResult from_message(const wire::CalibrationResult& message);

} // namespace dyncal::services
