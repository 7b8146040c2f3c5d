// Whether a channel shows a sine of a step's frequency where the step may have been: between the
// steps beside it that were found in its source. It tells a step that nobody excited from one whose
// sync signal is missing.
//
// A sine that lasts from the first sample to the last beside a mains line is hum. Costs what the
// search for the step cost. Plain function, any thread.
#pragma once

#include <cstddef>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/run_records.hpp"

namespace dyncal::inline evaluation {

enum class ShownSine {
  shown,
  not_shown,
  unknown, // there are no samples, they have not all come, or are not all held any more
};

[[nodiscard]] ShownSine shown_sine(const Recipe& recipe, const RunRecords& records,
                                   std::size_t step, const ChannelName& channel);

} // namespace dyncal::inline evaluation
