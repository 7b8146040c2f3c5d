// What a recipe leaves unstated, so that every uncertainty of its results holds without it: the
// uncertainty of the reference; in sample time stamping the calibration of the DAU's sync ADC, or
// at least the uncertainty of its delay; in series time stamping the uncertainty of the delay of
// the oscilloscope's trigger; that of the delay between the channels of the ACS. An uncertainty of
// 0 is not stated: nobody knows a delay exactly, and who means "negligible" can write how much that
// is.
//
// Plain function, any thread.
#pragma once

#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] std::vector<Flag> flags_of_unstated(const Recipe& recipe);

} // namespace dyncal::inline evaluation
