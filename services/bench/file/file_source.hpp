// The keys of [sources.NAME] with driver = "file": a recorded series (drivers/files/README.md).
//
//   path = "record.csv"
//   play = "at-once"         or "real-time", or a factor: 10.0 is ten times faster than real time
//   sample_rate_hz = 20000   where the file has no time column
//   group = "0x1fe40000_MPU_9250"   the sensor of an HDF5 file that has several
//   u_stamp_s = 1e-7         standard uncertainty of its stamps, of UTC or of the clock they share
#pragma once

#include <filesystem>

#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

[[nodiscard]] FileSourceSettings read_file_source(TomlTable& table, NamedFiles& files);

// The key `play`: times real time; 0: at once.
[[nodiscard]] double read_play_speed(TomlTable& table);

} // namespace dyncal::inline bench
