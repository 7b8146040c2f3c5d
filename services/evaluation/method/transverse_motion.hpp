// What an exciter moves across the excited axis, in the channels that lie there (ISO 16063-21,
// annex A; ISO 16063-11, annex A: transverse motion).
//
// A channel across the excited axis sees S_t a + S a_t: its own transverse sensitivity S_t, and the
// transverse motion a_t of the exciter by its sensitivity S along its axis. The second cannot be
// told from the first. With the largest ratio r = |a_t| / |a|, of any phase, it is up to r S, a
// rectangle: u = r S / sqrt(3) in magnitude and phase. For S stands the largest transfer function
// of a channel of the same source and unit that lies along the excited axis; without one nothing
// can be said, and documents refuse the channel.
//
// Plain functions, any thread.
#pragma once

#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// Adds the row to the results of a step that need it; true for each that has got one.
[[nodiscard]] std::vector<bool> add_transverse_motion(const Recipe& recipe,
                                                      std::vector<StepResult>& results);

} // namespace dyncal::inline evaluation
