#include "services/evaluation/method/flag_of_most.hpp"

#include <algorithm>
#include <map>
#include <string>

#include <fmt/core.h>

namespace dyncal::inline evaluation {
namespace {

struct Count {
  std::size_t steps = 0, flagged = 0;
};

// One flag alone may be chance.
bool is_common(const Count& count) {
  return count.flagged >= 2 && 2 * count.flagged >= count.steps;
}

} // namespace

bool add_flag_of_most(ResultFlag kind, std::span<StepResult> results) {
  std::map<std::string, Count> of_channel;
  for (const StepResult& result : results) {
    Count& count = of_channel[result.channel];
    count.steps += result.valid ? 1 : 0;
    count.flagged += result.valid && has_flag(result.flags, kind) ? 1 : 0;
  }
  bool added = false;
  for (StepResult& result : results) {
    const Count& count = of_channel[result.channel];
    if (result.valid && !has_flag(result.flags, kind) && is_common(count)) {
      result.flags.push_back(flag_of_channel(
          kind, result.channel,
          fmt::format("so it is in {} of {} steps; here noise or a low frequency hides it",
                      count.flagged, count.steps)));
      added = true;
    }
  }
  return added;
}

} // namespace dyncal::inline evaluation
