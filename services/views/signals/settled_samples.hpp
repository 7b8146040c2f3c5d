// Which of the newest samples of a channel are of the step that is excited now, and settled.
//
// A step is announced before its excitation is on and again when it is steady, in instants of this
// host; its samples have stamps of their source and may come late. So
//
//   1. nothing counts that came before the step was heard to be steady;
//   2. going backwards in blocks of whole periods (0.05 s, or more where the noise asks for it),
//      blocks belong together while amplitude and phase go on: within 3 %, and as a frequency that
//      is off by 2e-3 turns the phase. The newest block is looked at and not used;
//   3. if they go on without a break to before the step was announced, they are of a step before,
//      whose samples came late. Where that cannot be seen only what came `max_lag` later counts;
//   4. they are settled when the means of their first and second half differ by less than 2e-3
//      beyond noise; older blocks are left out until that is so. Four are needed.
//
// A triggered record counts as a whole where it came since, and needs two blocks of a period.
//
// Nothing: settling. Plain functions; any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "services/views/signals/channel_ring.hpp"

namespace dyncal::inline views {

// Stamps of the first samples that came after the instants of a step.
struct StepWindow {
  std::int64_t announced_ns = 0;
  std::int64_t steady_ns = 0;
  std::optional<std::int64_t> certain_ns{}; // `max_lag` after steady; nothing: not yet
  bool is_triggered = false;
};

// A source that lags behind by more shows a step before as this one where both are alike.
inline constexpr std::chrono::seconds max_lag{2};

// Nothing: no sample has come since the step was steady.
[[nodiscard]] std::optional<StepWindow> step_window(const ChannelRing& ring,
                                                    ChannelRing::Instant announced,
                                                    ChannelRing::Instant steady, bool is_triggered);

// What find_settled() looks at: the newest samples back to a little before the step was announced.
[[nodiscard]] std::vector<Sample> samples_around(const ChannelRing& ring, const StepWindow& window);

struct SettledSamples {
  std::span<const Sample> samples; // part of those that were given
  analysis::Frequency frequency;   // the planned one as the clock of the source counts it
  // Of the amplitudes of the blocks beyond their noise, or the change from the first half to the
  // second: what noise hides of settling is in it.
  double scatter = 0.0;
};

[[nodiscard]] std::optional<SettledSamples> find_settled(std::span<const Sample> samples,
                                                         const StepWindow& window,
                                                         const analysis::Frequency& frequency);

} // namespace dyncal::inline views
