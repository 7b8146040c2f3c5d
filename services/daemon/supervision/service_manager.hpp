// Tells systemd how the program does: that it serves, that its main loop turns, that it ends.
//
// The protocol is that of `Type=notify` and WatchdogSec= (sd_notify(3)): datagrams to the socket
// that NOTIFY_SOCKET names. READY=1 goes out at the first turn of the main loop after serving(),
// so that it comes from the loop itself; from then on WATCHDOG=1 goes out with the turns, four
// times in each watchdog interval at most. A loop that hangs sends nothing, and systemd restarts
// the program.
//
// Does nothing where nobody listens, or in a build without libsystemd. Never blocks for longer than
// a full socket of the service manager does. Threads: turned() from the main loop; the others from
// any.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace dyncal::inline daemon {

// False: this build has no libsystemd.
[[nodiscard]] bool can_notify_service_manager();

class ServiceManager {
public:
  using Clock = std::chrono::steady_clock;

  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();

  // Everything is there to serve with; `status` is the line that `systemctl status` shows.
  void serving(std::string status);
  void turned(Clock::time_point now = Clock::now());
  void stopping();

private:
  enum class Stage { starting, about_to_serve, serving, stopping };

  std::chrono::microseconds watchdog_interval_{0}; // 0: nobody watches
  std::mutex mutex_;
  Stage stage_ = Stage::starting;
  std::string status_;
  Clock::time_point next_watchdog_;
};

} // namespace dyncal::inline daemon
