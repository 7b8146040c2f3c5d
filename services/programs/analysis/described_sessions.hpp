// Sessions of one source that its run has a description of. Of a source that restarts without end
// the newest `max_sessions` are known. Plain data, one thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace dyncal::inline programs {

class DescribedSessions {
public:
  static constexpr std::size_t max_sessions = 8;

  void add(std::uint64_t session) {
    if (!contains(session)) {
      sessions_.push_back(session);
    }
    if (sessions_.size() > max_sessions) {
      sessions_.pop_front();
    }
  }
  [[nodiscard]] bool contains(std::uint64_t session) const {
    return std::find(sessions_.begin(), sessions_.end(), session) != sessions_.end();
  }

private:
  std::deque<std::uint64_t> sessions_;
};

} // namespace dyncal::inline programs
