// The results of a step with what its evaluation by itself does not know: the channels' responses
// under other excitations, the motion across the axis, the attempt and the temperature.
//
// The Monte Carlo check of a result that has more rows than before is done again. Plain function;
// any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

void complete(const Recipe& recipe, std::uint32_t attempt, std::optional<double> temperature_degc,
              const std::stop_token& stop, std::vector<StepResult>& results);

} // namespace dyncal::inline evaluation
