// Bench time of a bench without a time of its own: the host's monotonic clock, in seconds since the
// object was made. Any thread.
#pragma once

#include <chrono>
#include <stop_token>

namespace dyncal::drivers::generator {

class HostClock {
public:
  [[nodiscard]] double now_s() const;
  // Waits until `time_s` or until a stop is requested; returns the time by then.
  [[nodiscard]] double wait_until_s(double time_s, const std::stop_token& stop) const;

private:
  std::chrono::steady_clock::time_point origin_ = std::chrono::steady_clock::now();
};

} // namespace dyncal::drivers::generator
