// The table [sources] of a bench file: one source a table, with the keys that all have (driver,
// channels, units, time_base) and those of its driver. Any thread.
#pragma once

#include <filesystem>
#include <vector>

#include "services/bench/source_settings.hpp"
#include "services/bench/toml_table.hpp"

namespace dyncal::services {

// Relative paths are resolved from `folder`. What is not valid is refused in the table.
[[nodiscard]] std::vector<SourceSettings> read_sources(TomlTable table,
                                                       const std::filesystem::path& folder);

} // namespace dyncal::services
