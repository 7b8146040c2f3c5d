// An interval of time in a source's own clock. Plain data; any thread.
#pragma once

#include <cstdint>

namespace dyncal::inline evaluation {

struct TimeInterval { // both ends included
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  friend bool operator==(const TimeInterval&, const TimeInterval&) = default;
};

} // namespace dyncal::inline evaluation
