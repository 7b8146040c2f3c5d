// Keeps a writer that never waits from running ahead of its readers, without waiting for one that
// hangs.
//
// After each window of messages it looks whether all of them were acknowledged, and asks its caller
// to wait until they are: so a source that is played faster than real time goes as fast as its
// readers, and no more is on the wire at once than a receive buffer holds. When nothing was
// acknowledged for `patience`, a reader hangs: then it lets everything pass, and anyone who keeps
// up loses nothing by that, until all is acknowledged again. One thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "services/bus/qos_profiles.hpp"
#include "services/contract/source_kind.hpp"
#include "services/stream/block_split.hpp"

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
      waits_until_ = std::min(waits_until_, now + patience_);
      if (now < waits_until_) {
        return false;
      }
      hanging_ = true;
    }
    waits_until_ = Instant::max();
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
  Instant waits_until_ = Instant::max();
  bool hanging_ = false;
};

// Less than half of what a live writer of such messages keeps for repairs, and of a receive buffer:
// fewer records, of which it keeps few, and more blocks of one packet. By the number of long blocks
// a source of those would wait for its readers every 0.3 s, and fall behind its instrument where
// their answers take as long.
[[nodiscard]] inline WritePace::Window pace_window(SourceKind kind, std::size_t block_bytes) {
  const bool secured = block_bytes <= max_secured_block_bytes;
  const auto profile = is_triggered(kind) ? bus::Profile::live_records : bus::Profile::live_samples;
  const int kept = bus::qos_of_writer(profile, secured).samples_per_key;
  return {.messages = static_cast<std::size_t>(2 * kept / 5), .bytes = std::size_t{1} << 20U};
}

} // namespace dyncal::inline stream
