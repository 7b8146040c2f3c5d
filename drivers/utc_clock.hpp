// The host's clock in the contract's form: int64 nanoseconds since 1970-01-01 UTC. Any thread.
#pragma once

#include <chrono>
#include <cstdint>

namespace dyncal::services {

[[nodiscard]] inline std::int64_t utc_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

} // namespace dyncal::services
