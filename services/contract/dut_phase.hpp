// What the bench file says of the phase of the channels under calibration over frequency.
//
// A sensor with a delay alone has phases on a straight line, and that line begins at 0 or, where
// sensor and reference point in opposite directions, at 180 degrees. Who knows the polarity says
// which; who calibrates near a resonance, or a sensor with a high-pass filter, says that it is
// neither, and no group delay is stated then. The closures of the phase ask for it; no value at a
// frequency depends on it. Any thread.
#pragma once

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline contract {

enum class DutPhase { delay, delay_from_0, delay_from_180, any };

// As bench file and contract spell it: "delay-from-180".
[[nodiscard]] constexpr const char* to_string(DutPhase phase) {
  return per_enumerator(phase, {"delay", "delay-from-0", "delay-from-180", "any"});
}

} // namespace dyncal::inline contract
