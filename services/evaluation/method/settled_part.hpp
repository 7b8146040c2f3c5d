// Settling found from the data (analysis/step/settling.hpp): how much of the beginning of a step is
// left out.
//
// Reference and channels under calibration are looked at from where the step's excitation was
// found, at the frequency that sync has in each source's own clock; the one that takes longest
// counts. A channel under calibration that says nothing of settling (no excitation there) is passed
// over. When the reference says nothing, or settling is longer than the recipe allows
// (`settling_s`), `settling_s` is left out and a flag says why. Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/evaluation/recipe.hpp"
#include "services/evaluation/step_message.hpp"

namespace dyncal::services {

// The columns of one source: its sync, and those whose settling counts.
struct SettlingColumns {
  const StepSamples& samples;
  std::size_t sync = 0;
  std::vector<std::size_t> settling{};
};

struct Settled {
  double settling_s = 0.0;
  std::vector<std::string> flags;
};

// `acs` has the reference as its first settling column.
[[nodiscard]] Settled settled_part(const RecipeStep& step, double frequency_search_rel,
                                   const SettlingColumns& acs, const SettlingColumns& sensor);

// What is left of a stretch, `duration_s` at the most.
[[nodiscard]] StretchOfTime without_settling(StretchOfTime stretch, double settling_s,
                                             double duration_s);

} // namespace dyncal::services
