// The way of a recipe through the contract's Measurement message, made where a run is announced and
// read where it is evaluated.
//
// Plain functions, any thread.
#pragma once

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/evaluation/recipe/recipe.hpp"

namespace dyncal::inline evaluation {

// Everything but state, time and message of the run.
[[nodiscard]] wire::Measurement to_message(const Recipe& recipe);

// Fails (bad_argument) with a role that is not "source/channel", a frequency that is none, and as
// check_recipe() does.
[[nodiscard]] Expected<Recipe> parse_recipe(const wire::Measurement& measurement);

} // namespace dyncal::inline evaluation
