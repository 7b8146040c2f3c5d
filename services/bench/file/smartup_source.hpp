// The keys of [sources.NAME] with driver = "smartup": one sensor of a SmartUp Unit.
//
//   listen = "0.0.0.0:7654"        address and UDP port of this host
//   sensor = "0xbccb0100"
//   sync_sensor = "0xbccb0a00"     sensor id that carries the sync ADC of later firmware
#pragma once

#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

[[nodiscard]] SmartupSourceSettings read_smartup_source(TomlTable& table);

} // namespace dyncal::inline bench
