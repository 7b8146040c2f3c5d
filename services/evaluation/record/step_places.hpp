// Which of the planned steps the excitations of a run are, in their order: by frequency, level and
// the time from one to the next.
//
// As many as possible find a place, those that both records show first. Among such choices the one
// counts that costs least, in parts of a missing step: ten times |ln| of the measured level over
// the planned one; the difference of the frequencies in parts of 1e-4 (the clock's rate taken off)
// and that of the time to the excitation before, both up to one; 0.3 for each excitation that is
// left out before or between them. What is left open after that, is in its order from the first
// step on; from the last one on where the record begins within a pause. Plain function, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/recorded_excitations.hpp"

namespace dyncal::inline evaluation {

struct ExcitationInRun {
  const FoundExcitation* shown = nullptr;
  std::int64_t begin_ns = 0; // in one clock for all
  bool is_complete = true;   // every record that is searched shows it
};

// By excitation, its place in the plan; nothing for those that find none.
[[nodiscard]] std::vector<std::optional<std::size_t>>
place_excitations(std::span<const RecipeStep* const> plan,
                  std::span<const ExcitationInRun> excitations, bool begins_late);

} // namespace dyncal::inline evaluation
