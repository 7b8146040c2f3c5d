// The keys of a bench file that series time stamping needs: an oscilloscope that triggers, and a
// sensor that records a series after it.
//
//   [sources.dso]  driver = "oscilloscope"   address = "192.168.1.20:5555" (or "vxi11:HOST") family
//   (default: by its identity)
//                  or path = "folder" with files of shots, for dyncal analyse
//                  sync_input = 1   sync_range_v = 20.0 (V peak to peak)   trigger_level_v = 0.0
//   [sources.tss]  driver = "series"   address = "HOST:PORT" or path = "folder"
//   (drivers/tss/README.md) [method]       kind = "series-timestamping"   sync_dso = "dso/sync" dut
//   = ["tss/acceleration_z"]
//                  shots = 5 (a step)   trigger_phase_correction = true
//   [corrections]  dso_delay = { file = "dso-delay.json" } as `dyncal calibrate dso-delay` writes
//   it, or { value_s = ..., u_s = ... }
#pragma once

#include <filesystem>
#include <vector>

#include "services/bench/bench_file.hpp"
#include "services/bench/toml_table.hpp"

namespace dyncal::services {

void read_oscilloscope_source(TomlTable& table, const std::filesystem::path& folder,
                              SourceSettings& source);
void read_series_source(TomlTable& table, const std::filesystem::path& folder,
                        SourceSettings& source);
// What [method] says about shots. REQUIRES: the roles are read.
void read_shots(TomlTable& table, const std::vector<SourceSettings>& sources,
                MethodSettings& method);
void read_trigger_delay(TomlTable& table, const std::filesystem::path& folder,
                        CorrectionSettings& corrections);

} // namespace dyncal::services
