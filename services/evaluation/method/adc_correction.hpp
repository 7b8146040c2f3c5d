// What a recipe knows of the ADC that records sync at the DAU. Plain functions, any thread.
#pragma once

#include <span>

#include "analysis/base/error.hpp"
#include "services/evaluation/recipe/recipe.hpp"

namespace dyncal::services {

// At the step's frequency, by the recipe's calibration; without one: no correction.
[[nodiscard]] analysis::Expected<analysis::AdcResponse>
adc_response(const SampleStampingRoles& roles, const RecipeStep& step);

// The ADC's lag is calibrated as one curve: its uncertainty shifts all phases alike in delay. The
// largest over the frequencies stands for all, s.
[[nodiscard]] double u_adc_delay_s(const SampleStampingRoles& roles,
                                   std::span<const double> frequencies_hz);

} // namespace dyncal::services
