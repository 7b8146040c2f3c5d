// What the bus shows now as lines, for pipes and logs: one for each clock, source, program, step
// and result, by a key that stays the same while the line changes. Anyone who prints those that
// changed has a log. Plain functions, any thread.
#pragma once

#include <map>
#include <string>

#include "services/network/bus_state.hpp"

namespace dyncal::inline programs {

[[nodiscard]] std::map<std::string, std::string>
laboratory_lines(const network::BusState& laboratory);

} // namespace dyncal::inline programs
