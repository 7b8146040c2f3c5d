// How far something is that takes long: "42 %, 12 s left", after 2 s, overwritten on a terminal, a
// line every 10 s elsewhere. Belongs to one thread.
#pragma once

#include <chrono>
#include <cstdio>

namespace dyncal::services {

class ShareLine {
public:
  explicit ShareLine(std::FILE* stream);
  ~ShareLine() { end(); }
  ShareLine(const ShareLine&) = delete;
  ShareLine& operator=(const ShareLine&) = delete;

  // `share` of 0 to 1 is done.
  void show(double share);
  // Ends the line, so that what follows begins on its own.
  void end();

private:
  using Clock = std::chrono::steady_clock;

  std::FILE* stream_;
  bool terminal_;
  bool open_ = false;
  Clock::time_point began_ = Clock::now();
  Clock::time_point next_;
};

} // namespace dyncal::services
