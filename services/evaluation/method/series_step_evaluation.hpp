// From the shots of one excitation step to its results: series time stamping, paper eqs. (5) to (8)
// (analysis/method/series_stamping.hpp).
//
// Series of another length than most are left out and named in a flag, and so is a step with fewer
// shots than planned. Whether the sensor starts with the trigger or with its next own sample is
// judged from the shots (analysis/method/start_latency.hpp), or as at earlier steps when these do
// not tell; a sensor that runs free gets the mean of half a sample interval corrected. A step that
// cannot be evaluated gives results that are not valid and name the reason. No state; the same
// records give the same bits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/method/nominal_frequency.hpp"
#include "analysis/method/start_latency.hpp"
#include "idl/dyncal.h"
#include "services/evaluation/method/shot_record.hpp"
#include "services/evaluation/recipe.hpp"
#include "services/evaluation/step_message.hpp"

namespace dyncal::services {

struct SeriesStepOutput {
  std::vector<wire::CalibrationResult> results;
  std::optional<analysis::NominalFrequency> rate;             // of the sensor, by eq. (6)
  analysis::StartKind start = analysis::StartKind::undecided; // for the steps that follow
};

// What the sources have recorded of one step.
struct SeriesStepRecords {
  const SourceRecord& acs;
  const StretchOfTime& acs_stretch;
  const SourceRecord& oscilloscope;
  const SourceRecord& sensor;
  const std::vector<ShotRecord::Shot>& shots;
};

[[nodiscard]] SeriesStepOutput evaluate_series_step(const Recipe& recipe, const RecipeStep& step,
                                                    const SeriesStepRecords& records,
                                                    analysis::StartKind start_so_far,
                                                    std::vector<std::string> flags);

} // namespace dyncal::services
