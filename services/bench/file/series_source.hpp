// The keys of [sources.NAME] with driver = "series": a sensor that records a series after every
// trigger (drivers/tss/README.md).
//
//   address = "HOST:PORT"   where the sensor sends its series
//   path = "series"         instead: the folder it writes them into
#pragma once

#include <filesystem>

#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

[[nodiscard]] SeriesSourceSettings read_series_source(TomlTable& table, NamedFiles& files);

} // namespace dyncal::inline bench
