#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::services {

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

} // namespace dyncal::services
