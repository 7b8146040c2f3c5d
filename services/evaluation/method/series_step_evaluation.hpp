// From the shots of one excitation step to its results: series time stamping, paper eqs. (5) to (8)
// (analysis/method/series_stamping.hpp).
//
// Series of another length than most are left out and named in a flag, and so is a step with fewer
// shots than planned. Whether the sensor starts with the trigger or with its next own sample is
// decided from the shots and what earlier steps have shown (analysis/method/start_latency.hpp); a
// sensor that runs free gets the mean of half a sample interval corrected. What else the shots show
// is looked at in series_checks.hpp.
//
// A step that cannot be evaluated gives results that are not valid and name the reason. No state;
// the same records give the same bits.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/method/nominal_frequency.hpp"
#include "analysis/method/shared_bend.hpp"
#include "analysis/method/shared_start_scatter.hpp"
#include "analysis/method/start_latency.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/record/run_records.hpp"
#include "services/evaluation/record/shot_record.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

struct SeriesStepInput {
  StepTask task;
  SourceInterval acs;
  const SourceRecord& oscilloscope; // for their descriptions
  const SourceRecord& sensor;
  std::vector<ShotRecord::Shot> shots;
  ShotRecord::Losses lost;
  analysis::StartKind start_so_far = analysis::StartKind::undecided;
};

struct SeriesStepOutput {
  std::vector<StepResult> results;
  std::optional<analysis::NominalFrequency> rate;             // of the sensor, by eq. (6)
  analysis::StartKind start = analysis::StartKind::undecided; // for the steps that follow
  analysis::StartEvidence start_evidence{};                   // for all of them at the end
  std::map<std::string, analysis::StepBend> bends{}; // by channel, for all of them at the end
};

[[nodiscard]] SeriesStepOutput evaluate_series_step(const SeriesStepInput& step);

// What all steps together tell of a start that is not free, in place of what this one told by
// itself, unless that is undecided; and the flag where they show that it scatters.
void add_shared_start(const analysis::SharedStartScatter& start, StepResult& result);

} // namespace dyncal::inline evaluation
