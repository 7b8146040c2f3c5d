#include "services/evaluation/record/announced_instants.hpp"

#include <algorithm>
#include <vector>

#include "analysis/base/statistics.hpp"

namespace dyncal::inline evaluation {
namespace {

void add_newest(std::deque<std::int64_t>& values, std::int64_t value) {
  values.push_back(value);
  if (values.size() > AnnouncedInstants::max_heard) {
    values.pop_front();
  }
}

} // namespace

void AnnouncedInstants::add(const std::string& source, const SourceBlock& block,
                            const BlockTimes& times) {
  sent_[source].add(block, times);
  std::int64_t& newest_ns = newest_heard_ns_.try_emplace(source, times.heard_ns).first->second;
  newest_ns = std::max(newest_ns, times.heard_ns);
}

void AnnouncedInstants::add_over(std::size_t step, std::int64_t heard_ns) {
  over_heard_ns_.emplace(step, heard_ns);
  for (const auto& [source, newest_ns] : newest_heard_ns_) {
    heard_ns = std::max(heard_ns, newest_ns);
  }
  over_known_ns_.emplace(step, heard_ns);
}

bool AnnouncedInstants::has_gone_on(const std::string& source, std::size_t step,
                                    std::chrono::nanoseconds duration) const {
  const auto newest = newest_heard_ns_.find(source);
  const auto over = over_known_ns_.find(step);
  return newest == newest_heard_ns_.end() || over == over_known_ns_.end() ||
         newest->second - over->second >= duration.count();
}

void AnnouncedInstants::hear(std::int64_t heard_ns) {
  add_newest(heard_ns_, heard_ns);
}

void AnnouncedInstants::follow(const std::string& source, std::int64_t newest_ns) {
  if (const auto steps = newest_when_over_ns_.find(source); steps != newest_when_over_ns_.end()) {
    for (auto& [step, stamp_ns] : steps->second) {
      stamp_ns = std::min(stamp_ns, newest_ns);
    }
  }
}

std::optional<std::int64_t> AnnouncedInstants::newest_when_over_ns(const std::string& source,
                                                                   std::size_t step) const {
  const auto steps = newest_when_over_ns_.find(source);
  if (steps == newest_when_over_ns_.end()) {
    return std::nullopt;
  }
  const auto found = steps->second.find(step);
  return found == steps->second.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::int64_t> AnnouncedInstants::over_ns(const std::string& source,
                                                       std::size_t step) const {
  const auto sent = sent_.find(source);
  const auto heard = over_heard_ns_.find(step);
  if (sent != sent_.end() && heard != over_heard_ns_.end()) {
    const auto instant = sent->second.at(heard->second);
    return instant ? std::optional(instant->stamp_ns) : std::nullopt;
  }
  return newest_when_over_ns(source, step);
}

void AnnouncedInstants::add_offset(const Sessions& sessions, std::int64_t offset_ns) {
  add_newest(offsets_ns_[sessions], offset_ns);
  if (offsets_ns_.size() > max_sessions) {
    offsets_ns_.erase(offsets_ns_.begin()); // they are counted upwards
  }
}

std::optional<std::int64_t> AnnouncedInstants::offset_ns(const Sources& sources,
                                                         const Sessions& sessions) const {
  if (const auto offset = offset_by_sent_blocks(sources)) {
    return offset;
  }
  const auto found = offsets_ns_.find(sessions);
  if (found == offsets_ns_.end()) {
    return std::nullopt;
  }
  std::vector<std::int64_t> offsets(found->second.begin(), found->second.end());
  return analysis::upper_median(offsets);
}

std::optional<std::int64_t> AnnouncedInstants::offset_by_sent_blocks(const Sources& sources) const {
  const auto first = sent_.find(sources.first);
  const auto second = sent_.find(sources.second);
  if (first == sent_.end() || second == sent_.end()) {
    return std::nullopt;
  }
  std::vector<std::int64_t> offsets;
  for (const std::int64_t heard_ns : heard_ns_) {
    const auto in_first = first->second.at(heard_ns);
    const auto in_second = second->second.at(heard_ns);
    if (in_first && in_second && in_first->is_between_samples && in_second->is_between_samples) {
      offsets.push_back(in_second->stamp_ns - in_first->stamp_ns);
    }
  }
  return offsets.empty() ? std::nullopt : std::optional(analysis::upper_median(offsets));
}

} // namespace dyncal::inline evaluation
