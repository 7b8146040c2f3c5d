// How far a long computation is, for anyone who shows its progress: what is done now, and how much
// of it. Counted and read from any thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace dyncal::inline base {

class WorkCount {
public:
  struct State {
    std::string what;      // "evaluating"
    std::string unit;      // of what is counted: "steps", "%"
    std::size_t total = 0; // 0: not known
    std::size_t done = 0;
    std::chrono::steady_clock::time_point began;
  };

  explicit WorkCount(std::string what) { begin(std::move(what), "", 0); }

  // What is done from now on; what was counted before is done with.
  void begin(std::string what, std::string unit, std::size_t total) {
    const std::scoped_lock lock(mutex_);
    state_ = {std::move(what), std::move(unit), total, 0, std::chrono::steady_clock::now()};
  }
  // Where nothing is counted but a share of 0 to 1 is known.
  void begin_share(std::string what) { begin(std::move(what), "%", 100); }
  void set_share_done(double share) {
    set_done(static_cast<std::size_t>(100.0 * std::clamp(share, 0.0, 1.0)));
  }
  void add_done() {
    const std::scoped_lock lock(mutex_);
    ++state_.done;
  }
  void set_done(std::size_t done) {
    const std::scoped_lock lock(mutex_);
    state_.done = done;
  }
  [[nodiscard]] State state() const {
    const std::scoped_lock lock(mutex_);
    return state_;
  }

private:
  mutable std::mutex mutex_;
  State state_;
};

using SharedWorkCount = std::shared_ptr<WorkCount>; // null: nobody wants to know

inline void begin_work(const SharedWorkCount& count, const char* what, const char* unit,
                       std::size_t total) {
  if (count) {
    count->begin(what, unit, total);
  }
}
inline void add_done(const SharedWorkCount& count) {
  if (count) {
    count->add_done();
  }
}

} // namespace dyncal::inline base
