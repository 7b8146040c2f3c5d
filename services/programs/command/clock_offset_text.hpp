// How far the clock of another host is from ours, for people. Plain function, any thread.
#pragma once

#include <string>

#include "services/bus/host_clocks/clock_offset.hpp"

namespace dyncal::inline programs {

// "+0.00041 s from ours (within 0.00020 s)": positive where the other clock is ahead. To what is
// known of it: of a clock that has not moved beyond that the text stays.
[[nodiscard]] std::string clock_offset_text(const ClockOffset& clock);

} // namespace dyncal::inline programs
