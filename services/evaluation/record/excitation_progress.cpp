#include "services/evaluation/record/excitation_progress.hpp"

#include <algorithm>

#include "idl/dyncal.h"

namespace dyncal::services {
namespace {

// Samples that a source's service received this long after a step was over belong to later times
// for sure: devices, services and clocks of hosts that keep time by NTP delay and differ by far
// less.
constexpr std::int64_t grace_ns = 2'000'000'000;

StepAnnouncement::State state_of(wire::ExcitationState state) {
  switch (state) {
  case wire::EXCITATION_DONE:
    return StepAnnouncement::State::done;
  case wire::EXCITATION_ABORTED:
    return StepAnnouncement::State::aborted;
  default:
    return StepAnnouncement::State::excited;
  }
}

} // namespace

StepAnnouncement from_message(const wire::Excitation& excitation) {
  return {excitation.step(), state_of(excitation.state()), excitation.window_begin_utc_ns(),
          excitation.window_end_utc_ns()};
}

void ExcitationProgress::announce(const StepAnnouncement& announcement) {
  const auto found =
      std::find_if(recipe_.steps.begin(), recipe_.steps.end(),
                   [&](const RecipeStep& step) { return step.step == announcement.step; });
  if (found == recipe_.steps.end()) {
    return;
  }
  const auto step = static_cast<std::size_t>(found - recipe_.steps.begin());
  steps_announced_ = std::max(steps_announced_, step + 1);
  if (announcement.state != StepAnnouncement::State::excited) {
    over_utc_ns_.emplace(step, announcement.window_end_utc_ns);
  }
  if (announcement.state == StepAnnouncement::State::aborted) {
    broken_off_.insert(step);
  }
  // Only the newest state is kept on the way: the announcement of a step implies that those before
  // it are over.
  for (std::size_t before = 0; before < step; ++before) {
    over_utc_ns_.emplace(before, announcement.window_begin_utc_ns);
  }
}

void ExcitationProgress::end(bool aborted) {
  ended_ = true;
  aborted_ = aborted_ || aborted;
}

std::size_t ExcitationProgress::steps_expected() const {
  return aborted_ ? std::min(steps_announced_, recipe_.steps.size()) : recipe_.steps.size();
}

std::optional<std::size_t> ExcitationProgress::excited_step() const {
  if (steps_announced_ == 0 || ended_ || is_announced_over(steps_announced_ - 1)) {
    return std::nullopt;
  }
  return steps_announced_ - 1;
}

bool ExcitationProgress::is_over_in(const SourceRecord& source, std::size_t step) const {
  if (cut_short_ || source.ended()) {
    return true;
  }
  const auto over = over_utc_ns_.find(step);
  return over != over_utc_ns_.end() && source.newest_received_utc_ns() > over->second + grace_ns;
}

} // namespace dyncal::services
