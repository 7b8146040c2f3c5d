// Whether the clock of a source stepped within a step (analysis/clock/clock_steps.hpp), and what
// that does to the value.
//
// A step by e turns what comes behind it by w e. With the parts p_b of the samples at the offsets
// E_b the sine found is z = sum p_b exp(i w E_b) of the true one: shorter by 1 - |z|, and turned
// against the part whose stamps are right, which nobody knows, by arg z - w E_b at most. Where sync
// is sampled beside what is compared, both are turned alike and only the length counts.
//
// The flag comes where one of them is more than half of the u of the value: less costs less than
// 3 % of the coverage. Plain functions, any thread.
#pragma once

#include <string>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

struct SteppedClock {
  std::string source;
  double magnitude_rel = 0.0; // by which the value may be off
  double phase_rad = 0.0;
};

// Nothing when the clock did not step. `linked_by_sync`: sync is sampled by the same clock.
[[nodiscard]] std::vector<SteppedClock> find_stepped_clock(const SelectedChannels& channels,
                                                           const analysis::Frequency& frequency,
                                                           bool linked_by_sync);

// REQUIRES: the result has its u.
void add_clock_check(const std::vector<SteppedClock>& stepped, StepResult& result);

} // namespace dyncal::inline evaluation
