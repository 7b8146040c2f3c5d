// The table [sources] of a bench file: one source a table, with the keys that all have (driver,
// channels, units, time_base) and those of its driver. Instruments (smartup, socket) may have
//
//   nominal_rate_hz = 1000.0   as the instrument is set; 'dyncal check' holds the excitation list
//                              against half of it, and nothing else uses it
//
// Any thread.
#pragma once

#include <filesystem>
#include <vector>

#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// Files are looked up in `files`. What is not valid is refused in the table.
[[nodiscard]] std::vector<SourceSettings> read_sources(TomlTable table, NamedFiles& files);

} // namespace dyncal::inline bench
