// Ends every wait of a driver from another thread, at once and for good.
//
// A wait on a device polls descriptor() beside the device's own descriptor (POLLIN): it is readable
// from the first raise() on and is never read, so every later wait ends as well. The function that
// waited fails with ErrorCode::disconnected or has an outcome "stopped" of its own.
//
// Services stop with std::stop_token; where they call a driver, a std::stop_callback raises the
// driver's signal.
//
// raise() and raised() may be called from any thread, raise() from a signal handler too, and more
// than once. The constructor throws std::system_error when the system is out of descriptors.
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
