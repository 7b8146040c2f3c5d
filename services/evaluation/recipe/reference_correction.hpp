// What a recipe knows of the response of its reference at a step. Plain function, any thread.
#pragma once

#include "analysis/base/error.hpp"
#include "services/evaluation/recipe/recipe.hpp"

namespace dyncal::inline evaluation {

// At the step's frequency and planned level, by the recipe's calibration; without one: 1.
[[nodiscard]] analysis::Expected<analysis::ReferenceResponse>
reference_response(const Recipe& recipe, const RecipeStep& step);

} // namespace dyncal::inline evaluation
