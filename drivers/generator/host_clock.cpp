#include "drivers/generator/host_clock.hpp"

#include <condition_variable>
#include <mutex>

namespace dyncal::drivers::generator {

double HostClock::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - origin_).count();
}

double HostClock::wait_until_s(double time_s, const std::stop_token& stop) const {
  const double left_s = time_s - now_s();
  if (left_s > 0.0) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any stopped;
    stopped.wait_for(lock, stop, std::chrono::duration<double>(left_s), [] { return false; });
  }
  return now_s();
}

} // namespace dyncal::drivers::generator
