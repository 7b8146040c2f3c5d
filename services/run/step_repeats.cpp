#include "services/run/step_repeats.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::inline run {
namespace {

std::set<std::string> channels_of(const std::vector<StepResult>& results, bool valid_only) {
  std::set<std::string> channels;
  for (const StepResult& result : results) {
    if (result.valid || !valid_only) {
      channels.insert(result.channel);
    }
  }
  return channels;
}

// Empty when another attempt would not make it better.
std::string reason_in(const StepResult& result) {
  if (result.lost > 0) {
    return fmt::format("{} samples lost", result.lost);
  }
  for (const Flag& flag : result.flags) {
    if (may_be_cured(flag.kind)) {
      return flag.sentence;
    }
  }
  const bool refused = std::any_of(result.flags.begin(), result.flags.end(), [](const Flag& flag) {
    return flag.kind == ResultFlag::over_range || flag.kind == ResultFlag::values_stuck;
  });
  return result.valid || refused ? "" : result.problem;
}

} // namespace

std::uint32_t StepRepeats::begin(std::uint32_t step) {
  broken_off_.erase(step);
  asked_for_.erase(step);
  return ++begun_[step];
}

void StepRepeats::ask_for(std::uint32_t step) {
  if (std::find(steps_.begin(), steps_.end(), step) != steps_.end()) {
    asked_for_.insert(step);
  }
}

std::uint32_t StepRepeats::attempts_of(std::uint32_t step) const {
  const auto found = begun_.find(step);
  return found == begun_.end() ? 0 : found->second;
}

bool StepRepeats::is_evaluated(std::uint32_t step, const std::vector<StepResult>& results) const {
  const auto count = std::count_if(results.begin(), results.end(), [&](const StepResult& result) {
    return result.step == step && result.attempt >= attempts_of(step);
  });
  return count > 0 && static_cast<std::size_t>(count) >= channels_of(results, false).size();
}

bool StepRepeats::are_evaluated(const std::vector<StepResult>& results) const {
  return std::all_of(begun_.begin(), begun_.end(),
                     [&](const auto& step) { return is_evaluated(step.first, results); });
}

std::string StepRepeats::reason_to_repeat(std::uint32_t step,
                                          const std::vector<StepResult>& results) const {
  if (broken_off_.contains(step)) {
    return "its excitation was broken off";
  }
  const std::set<std::string> working = channels_of(results, true);
  std::string reason;
  for (const StepResult& result : results) {
    const bool counts = working.contains(result.channel) || steps_.size() == 1;
    if (result.step == step && counts && reason.empty()) {
      reason = reason_in(result);
    }
  }
  return reason;
}

std::optional<StepRepeat> StepRepeats::next(const std::vector<StepResult>& results) const {
  std::optional<StepRepeat> best;
  for (const std::uint32_t step : steps_) {
    std::string reason = reason_to_repeat(step, results);
    const bool asked_for = asked_for_.contains(step);
    if (!asked_for && (reason.empty() || attempts_of(step) >= attempts_)) {
      continue;
    }
    if (!best || attempts_of(step) < attempts_of(best->step)) {
      best = StepRepeat{step, asked_for ? "asked for" : std::move(reason)};
    }
  }
  return best;
}

} // namespace dyncal::inline run
