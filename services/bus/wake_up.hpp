// A bell that readers ring when something has come: one thread waits, any thread rings.
//
// A ring that comes before the wait is remembered; several count as one.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace dyncal::bus {

class WakeUp {
public:
  void ring();
  // Returns true if it rang since the last wait, false if the time ran out. A deadline in the past
  // asks without waiting.
  bool wait_until(std::chrono::steady_clock::time_point deadline);

private:
  std::mutex mutex_;
  std::condition_variable condition_;
  bool rung_ = false;
};

} // namespace dyncal::bus
