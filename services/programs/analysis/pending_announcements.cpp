#include "services/programs/analysis/pending_announcements.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::size_t max_steps = 4096;

} // namespace

void PendingAnnouncements::add(StepAnnouncement announcement, Instant heard) {
  steps_.emplace_back(std::move(announcement), heard);
  if (steps_.size() > max_steps) {
    steps_.pop_front();
  }
}

bool PendingAnnouncements::hand_over(RunEvaluator& evaluator) {
  for (; !steps_.empty(); steps_.pop_front()) {
    const auto& [announcement, heard] = steps_.front();
    evaluator.announce(announcement, heard.time_since_epoch().count());
  }
  const auto aborted = std::exchange(ended_, std::nullopt);
  if (aborted) {
    evaluator.end_of_excitation(*aborted);
  }
  return aborted.has_value();
}

} // namespace dyncal::inline programs
