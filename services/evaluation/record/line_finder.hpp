// What searches for an excitation (analysis/step/excitation_window.hpp): for its one frequency, or
// in the first of the lines of a multi-sine. Plain function, any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/step/excitation_window.hpp"
#include "services/evaluation/recipe/recipe.hpp"

namespace dyncal::inline evaluation {

// REQUIRES: one line, or all that are excited together.
[[nodiscard]] inline analysis::ExcitationWindowFinder finder_of(std::span<const RecipeStep> lines) {
  std::vector<analysis::Frequency> beside;
  for (const RecipeStep& line : lines.subspan(1)) {
    beside.push_back(line.frequency);
  }
  return analysis::ExcitationWindowFinder(lines.front().frequency, {}, std::move(beside));
}

} // namespace dyncal::inline evaluation
