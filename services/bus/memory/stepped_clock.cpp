#include "services/bus/memory/stepped_clock.hpp"

#include <algorithm>
#include <stdexcept>

namespace dyncal::bus {

bool SteppedClock::wait(WakeUp& wake_up, Instant deadline) {
  const auto rang = [&] { return wake_up.wait_until(Instant::min()); };
  const std::chrono::nanoseconds until = deadline - start;
  bool woken = rang();
  while (!woken && run_next(until)) {
    woken = rang();
  }
  if (!woken) {
    move_to(until);
  }
  return woken;
}

void SteppedClock::at(std::chrono::nanoseconds elapsed, Action action) {
  actions_.emplace(elapsed, std::move(action));
}

void SteppedClock::every(std::chrono::nanoseconds interval, const Action& action) {
  at(elapsed_ + interval, [this, interval, action] {
    every(interval, action);
    action();
  });
}

void SteppedClock::advance(std::chrono::nanoseconds by) {
  const auto until = elapsed_ + by;
  while (run_next(until)) {
  }
  move_to(until);
}

bool SteppedClock::run_next(std::chrono::nanoseconds until) {
  const auto next = actions_.begin();
  if (next == actions_.end() || next->first > until) {
    return false;
  }
  move_to(next->first);
  const Action action = std::move(next->second);
  actions_.erase(next);
  action();
  return true;
}

void SteppedClock::move_to(std::chrono::nanoseconds elapsed) {
  elapsed_ = std::max(elapsed_, elapsed);
  if (elapsed_ > max_elapsed) {
    throw std::runtime_error("an hour of stepped time has passed: this test waits for nothing");
  }
}

} // namespace dyncal::bus
