// Which excitations of two records are the same: they have one frequency, and their instants agree
// with an offset and a rate between the clocks (clock_comparison.hpp).
//
// 1. Every two excitations of one frequency propose an offset. What else agrees with it becomes a
//    pair; what has no partner stays alone; all are in the order of their instants.
// 2. Possible is a proposal whose excitations fit into the plan one after the other, whether in
//    pairs or alone; where none does (a record holds more than the plan), those that leave fewest
//    alone and all that leave one more.
// 3. Among several, steps that follow each other at one frequency decide, by the phases and the
//    levels of sync; of steps of several frequencies, whether one offset fits all phases. A
//    proposal is taken when they contradict each other one more than three times as often; or when
//    they do not contradict it, it leaves nothing alone, and both records begin and end together.
//
// Nothing is taken where this does not decide: steps of one frequency, one level and one distance
// whose phases go on alike, with the beginning or the end missing in one record; or where the plan
// has room for all of one record before all of the other, and no phase confirms that they share a
// step. Plain function, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/recorded_excitations.hpp"

namespace dyncal::inline evaluation {

// Places in the lists of the records; at least one of them.
struct JoinedExcitation {
  std::optional<std::size_t> first{};
  std::optional<std::size_t> second{};
  friend bool operator==(const JoinedExcitation&, const JoinedExcitation&) = default;
};

[[nodiscard]] bool could_be(const FoundExcitation& excitation, const RecipeStep& step);

[[nodiscard]] std::optional<std::vector<JoinedExcitation>>
join_excitations(std::span<const RecipeStep* const> plan, const RecordedExcitations& first,
                 const RecordedExcitations& second);

} // namespace dyncal::inline evaluation
