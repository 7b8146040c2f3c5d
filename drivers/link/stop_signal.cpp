#include "drivers/link/stop_signal.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <system_error>

#include <poll.h>
#include <sys/eventfd.h>

namespace dyncal::drivers {

StopSignal::StopSignal() : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!event_.is_open()) {
    throw std::system_error(errno, std::generic_category(), "cannot make an event to stop waits");
  }
}

void StopSignal::raise() {
  eventfd_write(event_.number(), 1); // fails only when it is raised already, 2^64 - 2 times
}

bool StopSignal::raised() const {
  return wait_for(std::chrono::nanoseconds(0));
}

bool StopSignal::wait_for(std::chrono::nanoseconds limit) const {
  using Clock = std::chrono::steady_clock;
  constexpr std::int64_t ns_per_s = 1'000'000'000;
  const auto deadline = Clock::now() + limit;
  for (;;) {
    const std::int64_t left_ns =
        std::max<std::int64_t>(0, std::chrono::nanoseconds(deadline - Clock::now()).count());
    const timespec left{left_ns / ns_per_s, left_ns % ns_per_s};
    pollfd watched{event_.number(), POLLIN, 0};
    if (ppoll(&watched, 1, &left, nullptr) > 0) {
      return true;
    }
    if (Clock::now() >= deadline) {
      return false;
    }
  }
}

} // namespace dyncal::drivers
