// Which steps of a run are excited again, after the planned ones: those whose result another
// attempt may improve, and those that somebody asks for.
//
// A step is worth another attempt when its excitation was broken off, when it has no result, or
// when the result of a channel is not valid, has lost samples, or carries a flag that does not come
// again by itself (may_be_cured(), result_flag.hpp). A channel without a valid result in any step
// of the run is no reason: that is a matter of the set-up, which repeating does not change. No step
// is excited more often than `attempts` times, but on request.
//
// Belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline run {

struct StepRepeat {
  std::uint32_t step = 0; // as the recipe numbers it
  std::string reason;     // "50 samples lost"
};

class StepRepeats {
public:
  StepRepeats(std::vector<std::uint32_t> steps, int attempts)
      : steps_(std::move(steps)), attempts_(static_cast<std::uint32_t>(attempts)) {}

  // A step is excited once more; returns which attempt that is, from 1.
  std::uint32_t begin(std::uint32_t step);
  // Its excitation has not come to its planned end.
  void broken_off(std::uint32_t step) { broken_off_.insert(step); }
  // Passes over a step that the plan does not have.
  void ask_for(std::uint32_t step);

  [[nodiscard]] std::uint32_t attempts_of(std::uint32_t step) const;
  // The step has the results of its last attempt, of every channel that has shown so far.
  [[nodiscard]] bool is_evaluated(std::uint32_t step, const std::vector<StepResult>& results) const;
  // So has every step that was excited.
  [[nodiscard]] bool are_evaluated(const std::vector<StepResult>& results) const;
  // The next one: of those with the fewest attempts, the first of the plan. Nothing when all is as
  // good as it can be made. REQUIRES: are_evaluated(results)
  [[nodiscard]] std::optional<StepRepeat> next(const std::vector<StepResult>& results) const;

private:
  [[nodiscard]] std::string reason_to_repeat(std::uint32_t step,
                                             const std::vector<StepResult>& results) const;

  std::vector<std::uint32_t> steps_;
  std::uint32_t attempts_;
  std::map<std::uint32_t, std::uint32_t> begun_; // attempts, by step
  std::set<std::uint32_t> broken_off_;           // in its last attempt
  std::set<std::uint32_t> asked_for_;
};

} // namespace dyncal::inline run
