// Gathers the results of a run and sums them up per channel: mean over repetitions at every
// frequency, scatter, unwrapped phase, group delay with intercept and covariance
// (analysis/method/repetitions.hpp, analysis/response/group_delay.hpp).
//
// Belongs to one thread; the recipe must outlive it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/evaluation/recipe.hpp"

namespace dyncal::services {

class TransferSummary {
public:
  explicit TransferSummary(const Recipe& recipe) : recipe_(recipe) {}

  // A result with the key of an earlier one takes its place.
  void add(const wire::CalibrationResult& result);

  // One for every channel that has at least one valid result.
  [[nodiscard]] std::vector<wire::TransferFunction> transfer_functions() const;

private:
  using StepKey = std::pair<std::uint32_t, std::uint32_t>; // step, repetition

  const Recipe& recipe_;
  std::vector<std::string> channels_; // in the order of their first result
  std::map<std::string, std::map<StepKey, wire::CalibrationResult>> results_;
};

} // namespace dyncal::services
