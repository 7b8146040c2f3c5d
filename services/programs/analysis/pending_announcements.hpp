// What was announced of a run while samples of its sources were still to be caught up with: it is
// of the samples that have come, and is handed over with them.
//
// At most 4096 steps; then the oldest goes, since one implies that those before it are over.
// Belongs to the service's one thread.
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "services/bus/clock.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::inline programs {

class PendingAnnouncements {
public:
  using Instant = bus::Clock::Instant;

  void add(StepAnnouncement announcement, Instant heard);
  void end_excitation(bool aborted) { ended_ = aborted; }
  // Returns whether the end of the excitation was among it.
  bool hand_over(RunEvaluator& evaluator);

private:
  std::deque<std::pair<StepAnnouncement, Instant>> steps_; // and when it was heard
  std::optional<bool> ended_;                              // true: aborted
};

} // namespace dyncal::inline programs
