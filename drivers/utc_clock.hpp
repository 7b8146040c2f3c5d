// The host's clock as every stamp of this project: int64 nanoseconds since 1970-01-01 UTC, leap
// seconds as the system counts them. Any thread.
#pragma once

#include <chrono>
#include <cstdint>

namespace dyncal {

[[nodiscard]] inline std::int64_t utc_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

} // namespace dyncal
