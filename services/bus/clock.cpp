#include "services/bus/clock.hpp"

#include "drivers/utc_clock.hpp"

namespace dyncal::bus {
namespace {

class SystemClock final : public Clock {
public:
  Instant now() override { return std::chrono::steady_clock::now(); }
  std::int64_t utc_now_ns() override { return dyncal::utc_now_ns(); }
  bool wait(WakeUp& wake_up, Instant deadline) override { return wake_up.wait_until(deadline); }
};

} // namespace

Clock& system_clock() {
  static SystemClock clock; // has no state
  return clock;
}

} // namespace dyncal::bus
