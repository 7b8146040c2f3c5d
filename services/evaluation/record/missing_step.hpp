// Why a step of a run has no value, by what its records show of it and of the others: which record
// lacks it, and whether it had begun and gone on by then. Plain function, any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/excitation_pairs.hpp"
#include "services/evaluation/record/recorded_excitations.hpp"

namespace dyncal::inline evaluation {

// One sentence; empty where every record shows the step, or none shows any. `shown`: by step of the
// plan, what the records show of it.
[[nodiscard]] std::string why_missing(std::span<const RecipeStep* const> plan,
                                      const std::vector<RecordedExcitations>& records,
                                      const std::vector<JoinedExcitation>& shown, std::size_t step);

} // namespace dyncal::inline evaluation
