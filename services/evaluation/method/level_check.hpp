// Whether a step was excited at the planned level: the amplitude of the reference against the plan.
//
// The part of the level by which it may be off without a flag is the recipe's
// (Recipe::level_deviation_rel). A reference in another unit than m/s^2 cannot be compared with the
// plan, and a recipe without a level has none to compare with: then there is no flag. Plain
// function, any thread.
#pragma once

#include <optional>
#include <string>

#include "analysis/method/transfer_point.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] std::optional<Flag> find_level_deviation(const RecipeStep& step,
                                                       double level_deviation_rel,
                                                       const analysis::ChannelFit& reference,
                                                       const std::string& reference_unit);

} // namespace dyncal::inline evaluation
