// What a recipe leaves unstated, so that every uncertainty of its results holds without it: the
// uncertainty of the reference; in sample time stamping the calibration of the DAU's sync ADC, or
// at least the uncertainty of its delay. An uncertainty of 0 is not stated.
//
// Plain function, any thread.
#pragma once

#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::services {

[[nodiscard]] std::vector<Flag> flags_of_unstated(const Recipe& recipe);

} // namespace dyncal::services
