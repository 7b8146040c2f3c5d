// The closures of a run: what must hold over all of its results, channel by channel. They say
// nothing new about a value and change none; what is open is flagged and not certified.
//
// A channel has every kind, those that are not possible with the reason; what concerns several
// channels (clocks, level) stands with each of them. Plain functions, any thread.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "services/evaluation/closures/channel_run.hpp"

namespace dyncal::inline evaluation {

struct DescribedRun {
  const Recipe& recipe;
  std::string reference_unit;
  std::function<double(const std::string& source)> nominal_rate_hz; // 0: not stated
};

// Writes the closures of each function, with a flag where one is open. Returns, of `results`, those
// that do not agree with the other repetitions of their point: now flagged as well.
[[nodiscard]] std::vector<StepResult> add_closures(const DescribedRun& run,
                                                   std::span<const StepResult> results,
                                                   std::vector<TransferFunction>& functions);

} // namespace dyncal::inline evaluation
