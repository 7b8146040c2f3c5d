// Gathers the results of a run and sums them up per channel: mean over repetitions at every
// frequency, scatter, unwrapped phase, group delay with intercept and covariance
// (analysis/method/repetitions.hpp, analysis/response/group_delay.hpp).
//
// Belongs to one thread; the recipe must outlive it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

class TransferSummary {
public:
  explicit TransferSummary(const Recipe& recipe) : recipe_(recipe) {}

  // A result of the same channel, step and repetition as an earlier one takes its place.
  void add(const StepResult& result);

  // Of all channels, the last one of each step.
  [[nodiscard]] std::vector<StepResult> results() const;
  // One for every channel that has at least one valid result.
  [[nodiscard]] std::vector<TransferFunction> transfer_functions() const;

private:
  using StepKey = std::pair<std::uint32_t, std::uint32_t>; // step, repetition
  using ChannelResults = std::map<StepKey, StepResult>;

  [[nodiscard]] TransferFunction function_of(const std::string& channel) const;
  void add_group_delay(const std::vector<const StepResult*>& results,
                       TransferFunction& function) const;

  const Recipe& recipe_;
  std::vector<std::string> channels_; // in the order of their first result
  std::map<std::string, ChannelResults> results_;
};

} // namespace dyncal::inline evaluation
