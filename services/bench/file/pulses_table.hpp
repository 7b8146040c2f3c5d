// The table [sources.NAME.pulses]: the channel of an instrument that records the pulse-per-second
// output of a GPS receiver, by which its samples get UTC (drivers/pps/README.md).
//
//   channel = "pps"
//   edge = "rising"      or "falling": the one that is the second
//   delay_s = 0.0        from the second to the pulse at the input: cable and receiver
//   u_delay_s = 5e-8     standard uncertainty of that; required
//
// Any thread.
#pragma once

#include <optional>

#include "drivers/pps/pulse_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// Nothing where the source has no such table.
[[nodiscard]] std::optional<drivers::pps::PulseSettings> read_pulses(TomlTable& source);

} // namespace dyncal::inline bench
