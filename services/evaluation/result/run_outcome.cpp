#include "services/evaluation/result/run_outcome.hpp"

#include <algorithm>
#include <tuple>

namespace dyncal::inline evaluation {

void sort_outcome(RunOutcome& outcome) {
  const auto sort_by = [](auto& all, auto key) {
    std::ranges::stable_sort(all, [&](const auto& a, const auto& b) { return key(a) < key(b); });
  };
  sort_by(outcome.results, [](const StepResult& result) {
    return std::tie(result.step, result.repetition, result.channel);
  });
  sort_by(outcome.transfer_functions,
          [](const TransferFunction& function) { return function.channel; });
  sort_by(outcome.clock_reports, [](const ClockReport& report) { return report.source; });
  if (outcome.recipe) {
    const std::vector<std::string> order = outcome.recipe->sources();
    sort_by(outcome.sources, [&](const RunSource& source) {
      return std::ranges::find(order, source.source) - order.begin();
    });
  }
}

RunOutcome outcome_of(const Recipe& recipe) {
  RunOutcome outcome;
  outcome.bench = recipe.bench;
  outcome.run = recipe.run;
  outcome.method = recipe.method();
  outcome.recipe_sha256 = recipe.sha256;
  outcome.planned_steps = recipe.steps.size();
  outcome.recipe = recipe;
  return outcome;
}

} // namespace dyncal::inline evaluation
