// One step on its way to be evaluated: the recipe, the step, and the flags that its samples have
// got so far. A value; any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/run_records.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

struct StepTask {
  std::shared_ptr<const Recipe> recipe;
  std::size_t index = 0; // among the recipe's steps
  std::vector<Flag> flags{};
  std::stop_token given_up{}; // RunEvaluator::give_up()
  std::stop_token stop{};     // of its evaluation

  [[nodiscard]] const RecipeStep& step() const { return recipe->steps[index]; }
  [[nodiscard]] StepTask until(std::stop_token asked) const {
    return {recipe, index, flags, given_up, std::move(asked)};
  }
};

// With the flags that every method has: samples lost, step shorter than planned, excitation broken
// off, number of the step uncertain.
[[nodiscard]] StepTask make_step_task(std::shared_ptr<const Recipe> recipe, std::size_t step,
                                      const RunRecords& records,
                                      const std::vector<SourceInterval>& sources);

// Why a step has no interval in the source of this sync channel: what the whole records show where
// somebody has looked at them, and what is known of the source; else whether any channel of the run
// shows an excitation. The connection of sync only where another one does.
[[nodiscard]] std::string no_sine(const Recipe& recipe, const RunRecords& records, std::size_t step,
                                  const ChannelName& sync);

} // namespace dyncal::inline evaluation
