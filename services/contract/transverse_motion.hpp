// The largest motion of an exciter across its axis, over that along it, as its certificate states
// it. Plain data; any thread.
#pragma once

#include <string>
#include <vector>

namespace dyncal::inline contract {

struct TransverseMotionPoint {
  double frequency_hz = 0.0; // 0: at every frequency
  double ratio = 0.0;
};

struct TransverseMotion {
  std::vector<TransverseMotionPoint> points; // empty: not stated
  std::string source;                        // where they are from, for people
};

} // namespace dyncal::inline contract
