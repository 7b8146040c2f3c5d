// The keys of [sources.NAME] that each driver has. Triggered ones are a device or a folder of its
// files. Any thread.
#pragma once

#include "drivers/acs_driver.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// driver = "file": a recorded series (drivers/files/README.md).
//
//   path = "record.csv"      or a channel, "record.tdms:GROUP/CHANNEL", or a list of channels, of
//                            several files too
//   play = "at-once"         or "real-time", or a factor: 10.0 is ten times faster than real time
//   sample_rate_hz = 20000   where the file has no time column
//   group = "0x1fe40000_MPU_9250"   the sensor of an HDF5 file that has several, a group of TDMS
//   u_stamp_s = 1e-7         standard uncertainty of its stamps, of UTC or of the clock they share
//   time_offset_s = -37.0    added to its stamps, as where they are TAI
//   scale = { sync = 10.0 }  factors of the values of its channels
[[nodiscard]] FileSourceSettings read_file_source(TomlTable& table, NamedFiles& files);

// driver = "alsa": a sound device of this computer (drivers/alsa/README.md).
//
//   address = "hw:CARD=Device,DEV=0"   as ALSA names it
//   sample_rate_hz = 48000             format = "s24-3le"      channel_count = 2
//   scale = { reference = 98.1 }       value of full scale, by channel
[[nodiscard]] AlsaSourceSettings read_alsa_source(TomlTable& table);

// A driver of the table in acs_drivers.cpp, whose keys stand in its row.
[[nodiscard]] AcsSourceSettings read_acs_source(TomlTable& table, const drivers::AcsDriver& driver);

// The key `scale`: factors of channels.
[[nodiscard]] std::map<std::string, double> read_scale(TomlTable& table);

// The key `play`: times real time; 0: at once.
[[nodiscard]] double read_play_speed(TomlTable& table);

// driver = "can": a sensor on a CAN interface of this host, or in a recorded log.
// drivers/can/stream_settings.hpp explains what they mean.
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
[[nodiscard]] CanSourceSettings read_can_source(TomlTable& table, NamedFiles& files);

// driver = "oscilloscope": triggers on sync and starts a time series sensor.
//
//   address = "192.0.2.20:5555"   or "vxi11:HOST"
//   path = "shots"                  instead: the folder with files of shots, for dyncal analyse
//   family                          its SCPI dialect; default: by its identity
//   sync_input = 1                  input that sees sync
//   sync_range_v = 20.0             V peak to peak
//   trigger_level_v = 0.0
[[nodiscard]] OscilloscopeSourceSettings read_oscilloscope_source(TomlTable& table,
                                                                  NamedFiles& files);

// driver = "series": a sensor that records a series after every trigger
// (drivers/tss/README.md).
//
//   address = "HOST:PORT"   where the sensor sends its series
//   path = "series"         instead: the folder it writes them into
[[nodiscard]] SeriesSourceSettings read_series_source(TomlTable& table, NamedFiles& files);

// driver = "table": the steps of an analogue calibration system that evaluates itself
// (drivers/tables/README.md).
//
//   path = "results.csv"             the file with all loops; a list: a file a loop; or their
//   folder phase = "sync-minus-reference"   or "reference-minus-sync": what the table's phase is;
//   required format = "ptb-csv"               spektra-csv | spektra-prp; left out: by the content
//   amplitude = "peak"               or "rms"
//   coverage = 2.0                   standard uncertainties in a deviation of the table
//   u_amplitude_rel, u_phase_deg     in place of the table's deviations
//   phase_offset_deg = 180.0         added to sync - reference
//   first_loop, skip_first_rows, skip_last_rows
[[nodiscard]] TableSourceSettings read_table_source(TomlTable& table, NamedFiles& files);

} // namespace dyncal::inline bench
