#include "services/bus/wake_up.hpp"

namespace dyncal::bus {

void WakeUp::ring() {
  {
    const std::lock_guard lock(mutex_);
    rung_ = true;
  }
  condition_.notify_one();
}

bool WakeUp::wait_until(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  const bool rang = condition_.wait_until(lock, deadline, [this] { return rung_; });
  rung_ = false;
  return rang;
}

} // namespace dyncal::bus
