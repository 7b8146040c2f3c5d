// Ends every wait of a driver from another thread, at once and for good.
//
// A wait on a device polls descriptor() beside the device's own descriptor (poll, POLLIN): it is
// readable from the first raise() on and is never read, so every later wait ends as well. Whoever
// raised it is told by ErrorCode::disconnected or by the function's own "stopped" outcome.
//
// Services stop with std::stop_token; where they call a driver, a std::stop_callback raises the
// driver's signal.
//
// raise() and raised() may be called from any thread, raise() also from a signal handler and as
// often as one likes. If the system has no event left, the constructor throws std::system_error.
#pragma once

#include <chrono>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers {

class StopSignal {
public:
  StopSignal();

  void raise();
  [[nodiscard]] bool raised() const;
  // Returns true as soon as the signal is raised, false when `limit` has passed without it.
  [[nodiscard]] bool wait_for(std::chrono::nanoseconds limit) const;
  [[nodiscard]] int descriptor() const { return event_.number(); }

private:
  FileDescriptor event_;
};

} // namespace dyncal::drivers
