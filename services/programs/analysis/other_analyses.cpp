#include "services/programs/analysis/other_analyses.hpp"

namespace dyncal::inline programs {

void OtherAnalyses::add(const wire::ServiceStatus& status, Instant now) {
  if (status.run().to_string().empty() || !status.guarded_generator().empty()) {
    return; // a recorder or a guard: they lead no run
  }
  const std::string service = status.service().to_string();
  if (service == own_service_) {
    return;
  }
  const RunKey run{status.bench().to_string(), status.run().to_string()};
  if (leaders_.contains(run) || leaders_.size() < max_runs || make_room(now)) {
    leaders_[run] = {service, status.software(), status.arm(), now};
  }
}

bool OtherAnalyses::make_room(Instant now) {
  auto oldest = leaders_.end();
  for (auto one = leaders_.begin(); one != leaders_.end(); ++one) {
    const bool is_older = oldest == leaders_.end() || one->second.heard < oldest->second.heard;
    if (is_older && !in_use_(one->first)) {
      oldest = one;
    }
  }
  const bool found = oldest != leaders_.end();
  if (!found || now - oldest->second.heard <= silence_limit) {
    ++left_out_;
  }
  if (found) {
    leaders_.erase(oldest);
  }
  return found;
}

std::optional<OtherAnalyses::Leader> OtherAnalyses::last_leader(const RunKey& run) const {
  const auto found = leaders_.find(run);
  return found == leaders_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<OtherAnalyses::Leader> OtherAnalyses::leader(const RunKey& run, Instant now) const {
  auto last = last_leader(run);
  return last && now - last->heard <= silence_limit ? last : std::nullopt;
}

bool OtherAnalyses::must_give_way(const RunKey& run, bool armed, Instant now) const {
  const auto other = leader(run, now);
  if (!other) {
    return false;
  }
  const bool other_armed = other->arm != wire::ARM_WAITING;
  return other_armed == armed ? other->service < own_service_ : other_armed;
}

} // namespace dyncal::inline programs
