#include "services/analysis/other_analyses.hpp"

#include <algorithm>

namespace dyncal::services {

void OtherAnalyses::add(const wire::ServiceStatus& status, Instant now) {
  if (!status.recording().empty()) {
    return; // a recorder leads no run
  }
  const std::string service = status.service().to_string();
  if (service == own_service_) {
    return;
  }
  leaders_[{status.bench().to_string(), status.run().to_string()}] = {service, status.software(),
                                                                      status.arm(), now};
  if (leaders_.size() > max_runs) {
    leaders_.erase(
        std::min_element(leaders_.begin(), leaders_.end(), [](const auto& a, const auto& b) {
          return a.second.heard < b.second.heard;
        }));
  }
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

} // namespace dyncal::services
