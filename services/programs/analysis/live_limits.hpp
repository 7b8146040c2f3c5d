// How a run is evaluated while it is live: ahead of the end of its steps, or, where a Monte Carlo
// check takes long, on a thread of its own. Plain function, any thread.
#pragma once

#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::inline programs {

[[nodiscard]] EvaluationLimits live_limits(const Recipe& recipe);

} // namespace dyncal::inline programs
