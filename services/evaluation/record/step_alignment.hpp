// The steps of a run in its records, from all that these show: which excitations of two records are
// the same, which of the planned steps they are, and what is missing where.
//
// 1. Where the frequencies of what a record shows leave one place in the plan for each excitation,
//    that is its step; so it is where nothing is missing.
// 2. Else instants, phases and levels of sync join the records (excitation_pairs.hpp), and
//    frequencies, levels and times place what is joined in the plan (step_places.hpp).
// 3. Where steps of one frequency and level are missing in all records, and neither levels nor
//    times tell which, the places count from the first step, or from the last one where the records
//    begin within a pause; what would have another place the other way round, is uncertain.
// 4. A step that a record lacks has no value, and its problem names the record and the cause. Where
//    nothing tells which excitations are the same, no step has a value.
//
// Plain function, any thread. REQUIRES: one or two records.
#pragma once

#include <span>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/recorded_excitations.hpp"
#include "services/evaluation/record/run_schedule.hpp"

namespace dyncal::inline evaluation {

// `plan`: the steps in the order of their excitation.
[[nodiscard]] RunSchedule align_steps(std::span<const RecipeStep* const> plan,
                                      const std::vector<RecordedExcitations>& records);

} // namespace dyncal::inline evaluation
