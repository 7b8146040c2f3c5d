#include "services/programs/analysis/followed_runs.hpp"

#include <algorithm>

namespace dyncal::inline programs {
namespace {

bool has_ended(const OtherAnalyses::Leader& leader) {
  return leader.arm == wire::ARM_FINISHED || leader.arm == wire::ARM_REFUSED;
}

} // namespace

void FollowedRuns::add(const RunKey& key, const wire::Measurement& measurement, Instant now) {
  FollowedRun& run = at(key, now);
  run.since = run.messages == 0 ? now : run.since;
  run.measurement = measurement;
  run.heard = now;
  ++run.messages;
}

void FollowedRuns::add(const RunKey& key, const wire::Excitation& excitation, Instant now) {
  at(key, now).excitation = excitation;
}

int FollowedRuns::messages(const RunKey& key) const {
  const auto known = runs_.find(key);
  return known == runs_.end() ? 0 : known->second.messages;
}

FollowedRun& FollowedRuns::at(const RunKey& key, Instant now) {
  if (const auto known = runs_.find(key); known != runs_.end()) {
    return known->second;
  }
  if (runs_.size() >= max_runs) {
    const auto goes = std::ranges::min_element(runs_, {}, [](const auto& one) {
      return std::pair(one.second.messages > 1, one.second.heard);
    });
    left_out_ += now - goes->second.heard <= OtherAnalyses::silence_limit ? 1 : 0;
    runs_.erase(goes);
  }
  FollowedRun& run = runs_[key];
  run.since = run.heard = now;
  return run;
}

bool FollowedRuns::leads_other(const std::string& bench, Instant now) const {
  return std::ranges::any_of(runs_, [&](const auto& one) {
    const auto leader = others_.leader(one.first, now);
    return one.first.first == bench && leader && !has_ended(*leader);
  });
}

bool FollowedRuns::is_deserted(const RunKey& key, const FollowedRun& run, Instant now) const {
  const auto last = others_.last_leader(key);
  if (last && has_ended(*last)) {
    return false;
  }
  const Instant led_until = last ? std::max(last->heard, run.since) : run.since;
  return run.messages > 1 && now - led_until > OtherAnalyses::silence_limit &&
         now - run.heard <= OtherAnalyses::silence_limit;
}

std::map<RunKey, FollowedRun>::value_type* FollowedRuns::deserted(Instant now) {
  const auto found = std::ranges::find_if(runs_, [&](const auto& one) {
    return !one.second.left_alone && is_deserted(one.first, one.second, now);
  });
  return found == runs_.end() ? nullptr : &*found;
}

} // namespace dyncal::inline programs
