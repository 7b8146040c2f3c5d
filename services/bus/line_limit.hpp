// How many lines of a DDS library pass to the log: so many in 10 s, however many come, so that no
// fault of a library fills a disk, and the same line once in 10 min: of a participant that it
// refuses, Cyclone DDS says so twice a second. What is left out is more of the same. Any thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <mutex>
#include <string_view>
#include <utility>

namespace dyncal::bus {

class LineLimit {
public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds interval{10};
  static constexpr std::chrono::minutes repeat_interval{10};
  static constexpr std::size_t remembered = 64; // lines
  static constexpr int usual_lines = 100;

  explicit LineLimit(int lines = usual_lines) : lines_(lines) {}

  // `line`: without its time.
  [[nodiscard]] bool passes(std::string_view line, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    if (is_repeated(std::hash<std::string_view>{}(line), now)) {
      return false;
    }
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
  bool is_repeated(std::size_t line, Clock::time_point now) {
    std::erase_if(passed_lines_,
                  [&](const auto& one) { return now - one.second >= repeat_interval; });
    if (std::ranges::any_of(passed_lines_, [&](const auto& one) { return one.first == line; })) {
      return true;
    }
    passed_lines_.emplace_back(line, now);
    if (passed_lines_.size() > remembered) {
      passed_lines_.pop_front();
    }
    return false;
  }

  std::mutex mutex_;
  std::deque<std::pair<std::size_t, Clock::time_point>> passed_lines_; // hashes
  int lines_;
  int passed_ = 0; // since the beginning of the interval
  Clock::time_point begin_;
};

} // namespace dyncal::bus
