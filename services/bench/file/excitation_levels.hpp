// The levels of the excitation, one for each frequency: an amplitude of acceleration (`level`), of
// velocity (`level_velocity_m_s`) or of displacement (`level_displacement_mm`), each for all
// frequencies or one for each. Of several the one that asks for least holds at each frequency:
// 5 mm, then 0.2 m/s, then 50 m/s^2 is how exciters are driven.
//
// A level that follows from velocity or displacement has four significant digits, rounded down, so
// that it stays within what was asked for. Belongs to one thread.
#pragma once

#include <string>
#include <vector>

#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// In m/s^2. What cannot be a level is refused in `table`; `frequencies_hz` may hold texts that are
// none, which their own reader refuses.
[[nodiscard]] std::vector<double> read_levels(TomlTable& table,
                                              const std::vector<std::string>& frequencies_hz);

} // namespace dyncal::inline bench
