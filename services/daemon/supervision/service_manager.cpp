#include "services/daemon/supervision/service_manager.hpp"

#include <cstdint>

#ifdef DYNCAL_HAVE_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

namespace dyncal::inline daemon {
namespace {

constexpr int signs_per_interval = 4;

#ifdef DYNCAL_HAVE_SYSTEMD
std::chrono::microseconds watchdog_interval() {
  std::uint64_t microseconds = 0;
  return std::chrono::microseconds(sd_watchdog_enabled(0, &microseconds) > 0 ? microseconds : 0);
}

// A sign that does not get through is given up: the next one is due soon.
void notify(const std::string& text) {
  static_cast<void>(sd_notify(0, text.c_str()));
}
#else
std::chrono::microseconds watchdog_interval() {
  return std::chrono::microseconds(0);
}

void notify(const std::string& /*text*/) {}
#endif

} // namespace

bool can_notify_service_manager() {
#ifdef DYNCAL_HAVE_SYSTEMD
  return true;
#else
  return false;
#endif
}

ServiceManager::ServiceManager() : watchdog_interval_(watchdog_interval()) {}

void ServiceManager::serving(std::string status) {
  const std::lock_guard lock(mutex_);
  stage_ = Stage::about_to_serve;
  status_ = std::move(status);
}

void ServiceManager::turned(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (stage_ == Stage::about_to_serve) {
    stage_ = Stage::serving;
    notify("READY=1\nSTATUS=" + status_);
    next_watchdog_ = now;
  }
  const bool watched = stage_ == Stage::serving && watchdog_interval_.count() > 0;
  if (watched && now >= next_watchdog_) {
    notify("WATCHDOG=1");
    next_watchdog_ = now + watchdog_interval_ / signs_per_interval;
  }
}

void ServiceManager::stopping() {
  const std::lock_guard lock(mutex_);
  if (stage_ != Stage::stopping) {
    stage_ = Stage::stopping;
    notify("STOPPING=1");
  }
}

} // namespace dyncal::inline daemon
