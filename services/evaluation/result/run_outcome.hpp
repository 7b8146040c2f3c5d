// What a run leaves behind, whether it was evaluated here or collected from the bus. Plain data;
// any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "services/contract/evaluation_method.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/clock_report.hpp"
#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::services {

struct RunOutcome {
  std::string bench;
  std::string run;
  EvaluationMethod method = EvaluationMethod::sample_timestamping;
  std::string recipe_sha256;
  std::size_t planned_steps = 0;
  std::string analysis_dds;        // DDS implementation of the analysis service; "none" offline
  std::vector<StepResult> results; // in the order of steps, then as they came
  std::vector<TransferFunction> transfer_functions;
  std::vector<ClockReport> clock_reports;
  bool interrupted = false;
  std::string problem; // why the run ended early; empty when it did not
};

// Of a run that has no results yet.
[[nodiscard]] RunOutcome outcome_of(const Recipe& recipe);

} // namespace dyncal::services
