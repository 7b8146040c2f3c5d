#include "services/evaluation/record/excitation_progress.hpp"

#include <algorithm>

#include "idl/dyncal.h"

namespace dyncal::inline evaluation {
namespace {

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
  return {excitation.step(), state_of(excitation.state()), std::max(excitation.attempt(), 1U),
          excitation.repeated_steps()};
}

void ExcitationProgress::announce(const StepAnnouncement& announcement) {
  order_.repeat(announcement.repeated_steps);
  order_.repeat(announcement.step, announcement.attempt);
  const auto found = order_.find(announcement.step, announcement.attempt);
  if (!found) {
    return;
  }
  const std::size_t step = *found;
  steps_announced_ = std::max(steps_announced_, step + 1);
  is_conducted_ = true;
  if (announcement.state != StepAnnouncement::State::excited) {
    over_.insert(step);
  }
  if (announcement.state == StepAnnouncement::State::aborted) {
    broken_off_.insert(step);
  }
  // Only the newest state is kept on the way: the announcement of a step implies that those before
  // it are over.
  for (std::size_t before = 0; before < step; ++before) {
    over_.insert(before);
  }
}

void ExcitationProgress::end(bool aborted) {
  ended_ = true;
  aborted_ = aborted_ || aborted;
}

std::size_t ExcitationProgress::steps_expected() const {
  return aborted_ ? steps_announced_ : order_.size();
}

std::size_t ExcitationProgress::steps_begun() const {
  return is_conducted_ && !ended_ && !cut_short_ ? steps_announced_ : steps_expected();
}

std::optional<std::size_t> ExcitationProgress::excited_step() const {
  if (steps_announced_ == 0 || ended_ || is_announced_over(steps_announced_ - 1)) {
    return std::nullopt;
  }
  return steps_announced_ - 1;
}

} // namespace dyncal::inline evaluation
