// The keys of [sources.NAME] with driver = "oscilloscope": the oscilloscope that triggers on sync
// and starts a time series sensor.
//
//   address = "192.0.2.20:5555"   or "vxi11:HOST"
//   path = "shots"                  instead: the folder with files of shots, for dyncal analyse
//   family                          its SCPI dialect; default: by its identity
//   sync_input = 1                  input that sees sync
//   sync_range_v = 20.0             V peak to peak
//   trigger_level_v = 0.0
#pragma once

#include <filesystem>

#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

[[nodiscard]] OscilloscopeSourceSettings read_oscilloscope_source(TomlTable& table,
                                                                  NamedFiles& files);

} // namespace dyncal::inline bench
