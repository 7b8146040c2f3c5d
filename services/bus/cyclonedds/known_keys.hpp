// Keys that were seen, by their MD5: some writers tell of the end of an instance by that alone.
//
// The newest `max_keys` are known, which is what a few runs have: of older ones the end is not
// understood, and shows when their writer goes, as each run's does. Bounds what a program that
// looks at every run holds to about 1.5 MB a topic. Any thread.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <mutex>
#include <optional>

#include "services/bus/cdr_key.hpp"

namespace dyncal::bus {

class KnownKeys {
public:
  static constexpr std::size_t max_keys = 4096;

  void remember(const KeyHash& hash, const Key& key) {
    const std::lock_guard lock(mutex_);
    if (!keys_.try_emplace(hash, key).second) {
      return;
    }
    oldest_first_.push_back(hash);
    if (oldest_first_.size() > max_keys) {
      keys_.erase(oldest_first_.front());
      oldest_first_.pop_front();
    }
  }
  [[nodiscard]] std::optional<Key> recall(const KeyHash& hash) const {
    const std::lock_guard lock(mutex_);
    const auto known = keys_.find(hash);
    return known == keys_.end() ? std::nullopt : std::optional(known->second);
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return keys_.size();
  }

private:
  mutable std::mutex mutex_;
  std::map<KeyHash, Key> keys_;
  std::deque<KeyHash> oldest_first_;
};

} // namespace dyncal::bus
