// A clock that stands still until somebody waits: the time of unit tests.
//
// A wait runs what the test has scheduled, in order of time, until the wake-up rings or the
// deadline is there; only then has time moved, and never by itself. So a run of minutes takes
// milliseconds and has the same course every time. After an hour (of this clock) it throws, which
// ends a test that waits for something that never comes.
//
// Belongs to one thread: the one that waits also runs the actions.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>

#include "services/bus/clock.hpp"

namespace dyncal::bus {

class SteppedClock final : public Clock {
public:
  using Action = std::function<void()>;

  [[nodiscard]] Instant now() override { return start + elapsed_; }
  [[nodiscard]] std::int64_t utc_now_ns() override { return start_utc_ns + elapsed_.count(); }
  bool wait(WakeUp& wake_up, Instant deadline) override;

  // Since the clock was made.
  [[nodiscard]] std::chrono::nanoseconds elapsed() const { return elapsed_; }
  // Runs `action` when a wait or advance() passes that time; at once comes at the next one.
  void at(std::chrono::nanoseconds elapsed, Action action);
  // The same, again and again, first after one interval.
  void every(std::chrono::nanoseconds interval, const Action& action);
  // Moves time by itself, running what is due on the way.
  void advance(std::chrono::nanoseconds by);

private:
  static constexpr Instant start{std::chrono::hours(1)};
  static constexpr std::int64_t start_utc_ns = 1'800'000'000'000'000'000;
  static constexpr std::chrono::hours max_elapsed{1};

  // Runs the next action that is due until then; returns false if there is none.
  bool run_next(std::chrono::nanoseconds until);
  void move_to(std::chrono::nanoseconds elapsed);

  std::chrono::nanoseconds elapsed_{0};
  std::multimap<std::chrono::nanoseconds, Action> actions_;
};

} // namespace dyncal::bus
