#include "services/bus/fastdds/acknack_counts.hpp"

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
  const auto known = counts_.find(pair);
  if (known != counts_.end()) {
    return known->second;
  }
  if (counts_.size() >= max_pairs) {
    counts_.clear();
  }
  return counts_[pair];
}

std::uint32_t AcknackCounts::continued(const Pair& pair, std::uint32_t count) {
  Counts& counts = of(pair);
  counts.newest = std::max(counts.newest, count);
  return count + counts.begun_anew;
}

std::uint32_t AcknackCounts::begin_anew(const Pair& pair) {
  Counts& counts = of(pair);
  return counts.newest + ++counts.begun_anew;
}

} // namespace dyncal::bus
