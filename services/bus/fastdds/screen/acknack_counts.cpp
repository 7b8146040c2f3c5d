#include "services/bus/fastdds/screen/acknack_counts.hpp"

#include <algorithm>

namespace dyncal::bus {

AcknackCounts::Pair AcknackCounts::pair(std::span<const unsigned char> source,
                                        std::span<const unsigned char> entities) {
  Pair pair{};
  auto* rest = std::copy(source.begin(), source.end(), pair.begin());
  std::copy(entities.begin(), entities.end(), rest);
  return pair;
}

AcknackCounts::Counts& AcknackCounts::of(const Pair& pair) {
  if (const auto known = known_.find(pair); known != known_.end()) {
    return known->second;
  }
  if (newcomers_.size() >= max_newcomers && !newcomers_.contains(pair)) {
    newcomers_.clear();
  }
  return newcomers_[pair];
}

AcknackCounts::Passed AcknackCounts::continued(const Pair& pair, const Acknack& acknack,
                                               Instant now) {
  Counts& counts = of(pair);
  Passed passed{.count = acknack.count + counts.begun_anew};
  if (acknack.count > counts.newest) {
    passed.begins_anew = acknack.asks && acknack.base < counts.acknowledged &&
                         !(counts.began && now - *counts.began < min_interval);
    const bool is_known = counts.went_on || counts.began;
    counts.newest = acknack.count;
    counts.went_on = now;
    if (passed.begins_anew) {
      counts.began = now;
      counts.acknowledged = acknack.base;
    } else {
      counts.acknowledged = std::max(counts.acknowledged, acknack.base);
    }
    if (auto newcomer = is_known ? newcomers_.extract(pair) : AllCounts::node_type()) {
      if (known_.size() >= max_known) {
        known_.clear();
      }
      known_.insert(std::move(newcomer));
    }
  }
  return passed;
}

std::optional<std::uint32_t> AcknackCounts::begin_anew(const Pair& pair, Instant now) {
  Counts& counts = of(pair);
  if ((counts.went_on && now - *counts.went_on < min_silence) ||
      (counts.began && now - *counts.began < min_interval)) {
    return std::nullopt;
  }
  counts.began = now;
  counts.acknowledged = 0;
  return counts.newest + ++counts.begun_anew;
}

} // namespace dyncal::bus
