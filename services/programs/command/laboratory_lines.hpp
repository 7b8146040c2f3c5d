// What the bus shows now as lines, for pipes and logs: one for each clock, source, program, step
// and result, by a key that stays the same while the line changes. Anyone who prints those that
// changed has a log. Plain functions, any thread.
#pragma once

#include <map>
#include <string>

#include "services/bus/host_clocks/clock_offset.hpp"
#include "services/network/bus_state.hpp"

namespace dyncal::inline programs {

// "+0.00041 s from ours (within 0.00020 s)": positive where the other clock is ahead. To what is
// known of it: of a clock that has not moved beyond that the text stays.
[[nodiscard]] std::string clock_offset_text(const ClockOffset& clock);

[[nodiscard]] std::map<std::string, std::string>
laboratory_lines(const network::BusState& laboratory);

} // namespace dyncal::inline programs
