// What a recipe knows of the ADC that records sync at the DAU. Plain functions, any thread.
#pragma once

#include "analysis/base/error.hpp"
#include "services/evaluation/recipe/recipe.hpp"

namespace dyncal::inline evaluation {

// At the step's frequency, by the recipe's calibration; without one: no correction, and the
// uncertainty of the delay that the recipe states.
[[nodiscard]] analysis::Expected<analysis::AdcResponse>
adc_response(const SampleStampingRoles& roles, const RecipeStep& step);

} // namespace dyncal::inline evaluation
