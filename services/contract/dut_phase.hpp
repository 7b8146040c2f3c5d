// What the bench file says of the phase of the channels under calibration over frequency.
//
// A sensor with a delay alone has phases on a straight line, and that line begins at 0 or, where
// sensor and reference point in opposite directions, at 180 degrees. Who knows the polarity says
// which; who calibrates near a resonance, or a sensor with a high-pass filter, says that it is
// neither, and no group delay is stated then. The closures of the phase ask for it; no value at a
// frequency depends on it. Any thread.
#pragma once

#include <optional>
#include <string_view>

namespace dyncal::inline contract {

enum class DutPhase { delay, delay_from_0, delay_from_180, any };

// As bench file and contract spell it: "delay-from-180".
[[nodiscard]] const char* to_string(DutPhase phase);
[[nodiscard]] std::optional<DutPhase> parse_dut_phase(std::string_view text);

} // namespace dyncal::inline contract
