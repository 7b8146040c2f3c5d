// Settling found from the data (analysis/step/settling.hpp): how much of the beginning of a step is
// left out.
//
// Reference and channels under calibration are looked at from where the step's excitation was
// found, at the frequency that sync has in each source's own clock; the one that takes longest
// counts. A channel under calibration that shows no settling (no excitation there) is passed over.
// Where none is found in the reference, or settling takes longer than the recipe allows
// (`settling_s`), `settling_s` is left out and a flag gives the reason. Any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

// The columns of one source: its sync, and those whose settling counts.
struct SettlingColumns {
  const StepSamples& samples;
  std::size_t sync = 0;
  std::vector<std::size_t> settling{};
};

struct StepSettling {
  double settling_s = 0.0;
  std::optional<Flag> flag{};
};

// `acs` has the reference as its first settling column.
[[nodiscard]] StepSettling find_settling_of_step(const RecipeStep& step,
                                                 double frequency_search_rel,
                                                 const SettlingColumns& acs,
                                                 const SettlingColumns& sensor);

// What is left of an interval, `duration_s` at the most.
[[nodiscard]] TimeInterval without_settling(TimeInterval interval, double settling_s,
                                            double duration_s);

// All columns from `first` on; sync is the first of all.
[[nodiscard]] SettlingColumns sensor_columns(const SelectedChannels& sensor, std::size_t first = 1);

} // namespace dyncal::inline evaluation
