// Time as a service sees it: instants that its limits are measured with, UTC for its messages, and
// waiting for messages.
//
// What has a time limit takes a Clock, so that a test can move time by itself
// (services/bus/memory/stepped_clock.hpp); programs use system_clock(). Anyone who has a Clock
// waits through it and through nothing else.
#pragma once

#include <chrono>
#include <cstdint>

#include "services/bus/wake_up.hpp"

namespace dyncal::bus {

class Clock {
public:
  using Instant = std::chrono::steady_clock::time_point;

  virtual ~Clock() = default;
  [[nodiscard]] virtual Instant now() = 0;
  // Nanoseconds since 1970-01-01 UTC.
  [[nodiscard]] virtual std::int64_t utc_now_ns() = 0;
  // Returns true if `wake_up` rang since the last wait, false if the deadline passed.
  virtual bool wait(WakeUp& wake_up, Instant deadline) = 0;
};

// The host's clocks. Any thread.
[[nodiscard]] Clock& system_clock();

} // namespace dyncal::bus
