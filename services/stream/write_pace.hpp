// Keeps a writer that never waits from running ahead of its readers, without waiting for one that
// hangs.
//
// After each window of messages it looks whether all of them were acknowledged, and asks its caller
// to wait until they are: so a source that is played faster than real time goes as fast as its
// readers, and no more is on the wire at once than a receive buffer holds. When nothing was
// acknowledged for `patience`, a reader hangs: then it lets everything pass, and anyone who keeps
// up loses nothing by that, until all is acknowledged again. One thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

namespace dyncal::inline stream {

class WritePace {
public:
  using Instant = std::chrono::steady_clock::time_point;

  struct Window {
    std::size_t messages = 100;
    std::size_t bytes = std::size_t{1} << 20U;
  };

  WritePace(Window window, std::chrono::nanoseconds patience)
      : window_(window), patience_(patience) {}

  // `acknowledged()` tells whether all that was written has been acknowledged.
  template <class Acknowledged>
  [[nodiscard]] bool may_write(Instant now, Acknowledged&& acknowledged) {
    if (messages_ < window_.messages && bytes_ < window_.bytes) {
      return true;
    }
    if (acknowledged()) {
      hanging_ = false;
    } else if (!hanging_) {
      waiting_since_ = waiting_since_.value_or(now);
      if (now - *waiting_since_ < patience_) {
        return false;
      }
      hanging_ = true;
    }
    waiting_since_.reset();
    messages_ = 0;
    bytes_ = 0;
    return true;
  }

  void wrote(std::size_t bytes) {
    ++messages_;
    bytes_ += bytes;
  }

  [[nodiscard]] bool hanging() const { return hanging_; }

private:
  const Window window_;
  const std::chrono::nanoseconds patience_;
  std::size_t messages_ = 0;
  std::size_t bytes_ = 0;
  std::optional<Instant> waiting_since_;
  bool hanging_ = false;
};

} // namespace dyncal::inline stream
