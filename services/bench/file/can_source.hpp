// The keys of [sources.NAME] with driver = "can": a sensor on a CAN interface of this host, or in a
// recorded log. drivers/can/stream_settings.hpp explains what they mean.
//
//   interface = "can0"               dbc = "sensor.dbc"
//   log = "drive.log"                a log of `candump -l`; `interface` then names one in it
//   play = "real-time"               of the log, as for files
//   messages = ["Sample"]            by name, or by id "0x123"
//   time_source = "counter"          canopen-sync | payload-time | counter | hardware-stamp |
//                                    kernel-stamp; left out: the best there is
//   counter = "SampleCounter"        nominal_rate_hz = 1000.0
//   time_field = "Time"              time_field_tick_s = 1e-6
//   bit_rate_per_s = 500000          data_bit_rate_per_s = 2000000
//                                    checked against the interface; needed for virtual ones
//   hardware_stamp_point = "start-of-frame"       end-of-frame | unknown
//   time_base = "local"              stamps of the host's clock without relation to UTC, for a
//                                    reference that is stamped by the same clock
//   latency_s, u_latency_s, u_utc_s, frame_duration_correction, bus_is_shared, sync_id,
//   hardware_tick_s, restart_after_bus_off_s
#pragma once

#include <filesystem>

#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

[[nodiscard]] CanSourceSettings read_can_source(TomlTable& table, NamedFiles& files);

} // namespace dyncal::inline bench
