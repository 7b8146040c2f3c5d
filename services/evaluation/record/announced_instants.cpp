#include "services/evaluation/record/announced_instants.hpp"

#include <algorithm>
#include <vector>

#include "analysis/base/statistics.hpp"

namespace dyncal::services {

void AnnouncedInstants::follow(const std::string& source, std::int64_t newest_ns) {
  if (const auto steps = over_ns_.find(source); steps != over_ns_.end()) {
    for (auto& [step, stamp_ns] : steps->second) {
      stamp_ns = std::min(stamp_ns, newest_ns);
    }
  }
}

std::optional<std::int64_t> AnnouncedInstants::over_ns(const std::string& source,
                                                       std::size_t step) const {
  const auto steps = over_ns_.find(source);
  if (steps == over_ns_.end()) {
    return std::nullopt;
  }
  const auto found = steps->second.find(step);
  return found == steps->second.end() ? std::nullopt : std::optional(found->second);
}

void AnnouncedInstants::add_offset(const Sessions& sessions, std::int64_t offset_ns) {
  auto& offsets = offsets_ns_[sessions];
  offsets.push_back(offset_ns);
  if (offsets.size() > max_offsets) {
    offsets.pop_front();
  }
  if (offsets_ns_.size() > max_sessions) {
    offsets_ns_.erase(offsets_ns_.begin()); // they are counted upwards
  }
}

std::optional<std::int64_t> AnnouncedInstants::offset_ns(const Sessions& sessions) const {
  const auto found = offsets_ns_.find(sessions);
  if (found == offsets_ns_.end()) {
    return std::nullopt;
  }
  std::vector<std::int64_t> offsets(found->second.begin(), found->second.end());
  return analysis::upper_median(offsets);
}

} // namespace dyncal::services
