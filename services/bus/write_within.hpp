// The retry of a DDS write while the history of a writer is full. A vendor's own wait may end long
// before the time that it was given: only our clock decides when time is up.
//
// `attempt` writes once and returns what came of it: `timed_out` is tried again until `limit` has
// passed, anything else is the result. At least one attempt is made. Any thread.
#pragma once

#include <chrono>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

template <typename Attempt>
[[nodiscard]] WriteOutcome write_within(std::chrono::nanoseconds limit, Attempt attempt) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (true) {
    const WriteOutcome outcome = attempt();
    if (outcome != WriteOutcome::timed_out || std::chrono::steady_clock::now() >= deadline) {
      return outcome;
    }
  }
}

} // namespace dyncal::bus
