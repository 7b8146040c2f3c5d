// The largest motion of an exciter across its axis, over that along it, as its certificate states
// it. Plain data and a function; any thread.
#pragma once

#include <optional>
#include <span>
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

// The larger one of those at the frequencies about it; nothing outside of them. A point without a
// frequency holds everywhere.
[[nodiscard]] std::optional<double> ratio_at(std::span<const TransverseMotionPoint> points,
                                             double frequency_hz);

} // namespace dyncal::inline contract
