// Lines for the log from threads that must not wait: the receiver's thread puts them here, the main
// thread prints them. Bound: max_lines lines; policy: further ones are left out and counted. Any
// number of threads add, one takes.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace dyncal::services::dau {

struct EventLine {
  bool warning = false;
  std::string text;
};

class EventLines {
public:
  static constexpr std::size_t max_lines = 1000;

  void add(bool warning, std::string text) {
    const std::lock_guard lock(mutex_);
    if (lines_.size() < max_lines) {
      lines_.push_back({warning, std::move(text)});
    } else {
      ++left_out_;
    }
  }

  // What has come since the last call, and how many lines were left out.
  [[nodiscard]] std::pair<std::vector<EventLine>, std::uint64_t> take() {
    const std::lock_guard lock(mutex_);
    return {std::exchange(lines_, {}), std::exchange(left_out_, 0)};
  }

private:
  std::mutex mutex_;
  std::vector<EventLine> lines_;
  std::uint64_t left_out_ = 0;
};

} // namespace dyncal::services::dau
