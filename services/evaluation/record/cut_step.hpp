// What is evaluated of a step within which a record begins: what would have been evaluated of all
// of it, as far as it is there. Where the step began follows from where it ends, and from how much
// longer than planned the other steps of the record last:
//
//   begin = end - settling - duration - (what the others last beyond that)
//
// Known to a frame of the search at either end; what lies within the evaluated part for sure is
// taken. Without this the settling time would be left out once more, and samples would count that
// count in no other step: from behind the planned duration. Plain function, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/recorded_excitations.hpp"
#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::inline evaluation {

// An excitation that begins with the record.
[[nodiscard]] bool begins_with_record(const FoundExcitation& first, std::int64_t record_begin_ns);

// Of the record's first excitation; nothing where the record holds its beginning, or does not tell
// when that was. `steps`: by excitation, the step it is; null where it is none.
[[nodiscard]] std::optional<TimeInterval>
evaluated_of_cut_step(const RecordedExcitations& record, std::span<const RecipeStep* const> steps);

} // namespace dyncal::inline evaluation
