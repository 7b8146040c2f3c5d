// How many lines of a DDS library pass to the log: so many in 10 s, however many come, so that no
// fault of a library fills a disk. What is left out is more of the same. Any thread.
#pragma once

#include <chrono>
#include <mutex>

namespace dyncal::bus {

class LineLimit {
public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds interval{10};
  static constexpr int usual_lines = 100;

  explicit LineLimit(int lines = usual_lines) : lines_(lines) {}

  [[nodiscard]] bool passes(Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    if (passed_ == 0 || now - begin_ >= interval) {
      begin_ = now;
      passed_ = 0;
    }
    if (passed_ == lines_) {
      return false;
    }
    ++passed_;
    return true;
  }

private:
  std::mutex mutex_;
  int lines_;
  int passed_ = 0; // since the beginning of the interval
  Clock::time_point begin_;
};

} // namespace dyncal::bus
