// The table [method] of a bench file: how the bench is evaluated, and which channel has which role.
//
//   kind = "analogue"              reference, dut: channels of one system
//   kind = "sample-timestamping"   reference, sync_acs, sync_dau, dut
//   kind = "series-timestamping"   reference, sync_acs, sync_dso, dut, shots = 5 (a step),
//                                  trigger_phase_correction = true
//   kind = "absolute-time"         reference, dut: stamped in UTC
//   temperature, frequency_search_rel, mains_hz, clock_tolerance_ppm, dut_phase:
//                                  with every kind
#pragma once

#include <vector>

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// What is not valid is refused in the table.
[[nodiscard]] MethodSettings read_method(TomlTable table,
                                         const std::vector<SourceSettings>& sources);

} // namespace dyncal::inline bench
