// How far something is that takes long, where no terminal shows it: "42 %, 12 s left", from 2 s on
// a line every 10 s; on a terminal nothing (work_progress.hpp). Belongs to one thread.
#pragma once

#include <chrono>
#include <cstdio>

namespace dyncal::inline programs {

class ShareLine {
public:
  explicit ShareLine(std::FILE* stream);
  ShareLine(const ShareLine&) = delete;
  ShareLine& operator=(const ShareLine&) = delete;

  // `share` of 0 to 1 is done.
  void show(double share);

private:
  using Clock = std::chrono::steady_clock;

  std::FILE* stream_;
  bool terminal_;
  Clock::time_point began_ = Clock::now();
  Clock::time_point next_;
};

} // namespace dyncal::inline programs
