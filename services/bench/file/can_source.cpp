#include "services/bench/file/driver_tables.hpp"

#include <cstdint>
#include <map>
#include <string>

#include <fmt/core.h>

namespace dyncal::inline bench {

namespace {

using drivers::can::StampPoint;
using drivers::can::TimeSource;

double positive(TomlTable& table, const std::string& key, const std::string& unit) {
  const auto value = table.optional_number(key, unit);
  if (value && *value <= 0.0) {
    table.refuse(key, "must be positive, in " + unit);
  }
  return value.value_or(0.0);
}

std::optional<double> uncertainty(TomlTable& table, const std::string& key) {
  const auto value = table.optional_number(key, "seconds");
  if (value && *value < 0.0) {
    table.refuse(key, "is a standard uncertainty and must not be negative");
  }
  return value;
}

std::optional<TimeSource> read_time_source(TomlTable& table) {
  static const std::map<std::string, TimeSource> sources{
      {"canopen-sync", TimeSource::canopen_sync},
      {"payload-time", TimeSource::payload_time},
      {"counter", TimeSource::counter},
      {"hardware-stamp", TimeSource::hardware_stamp},
      {"kernel-stamp", TimeSource::kernel_stamp}};
  const auto found = sources.find(table.one_of(
      "time_source",
      {"best", "canopen-sync", "payload-time", "counter", "hardware-stamp", "kernel-stamp"},
      "best"));
  return found == sources.end() ? std::nullopt : std::optional(found->second);
}

std::filesystem::path read_file_name(TomlTable& table, const std::string& key,
                                     const std::string& name, NamedFiles& files) {
  if (name.empty()) {
    return {};
  }
  const auto path = files.resolve(name);
  if (!std::filesystem::is_regular_file(path)) {
    table.refuse(key,
                 fmt::format("names {}, which does not exist or is not a file", path.string()));
  }
  return path;
}

StampPoint read_stamp_point(TomlTable& table) {
  const std::string name = table.one_of("hardware_stamp_point",
                                        {"start-of-frame", "end-of-frame", "unknown"}, "unknown");
  if (name == "start-of-frame") {
    return StampPoint::start_of_frame;
  }
  return name == "end-of-frame" ? StampPoint::end_of_frame : StampPoint::unknown;
}

// A positive number, or nothing when the key is not there.
std::optional<double> optional_positive(TomlTable& table, const std::string& key) {
  const double value = positive(table, key, "seconds");
  return value > 0.0 ? std::optional(value) : std::nullopt;
}

} // namespace

CanSourceSettings read_can_source(TomlTable& table, NamedFiles& files) {
  CanSourceSettings can;
  can.log = read_file_name(table, "log", table.text("log"), files);
  can.interface_name = can.log.empty() ? table.required_text("interface") : table.text("interface");
  can.dbc = read_file_name(table, "dbc", table.required_text("dbc"), files);
  can.messages = table.texts("messages");
  can.time_source = read_time_source(table);
  can.counter = table.text("counter");
  can.time_field = table.text("time_field");
  can.time_field_tick_s = positive(table, "time_field_tick_s", "seconds");
  can.nominal_rate_hz = positive(table, "nominal_rate_hz", "Hz");
  can.bit_rates = {positive(table, "bit_rate_per_s", "bit/s"),
                   positive(table, "data_bit_rate_per_s", "bit/s")};
  can.sync_id = static_cast<std::uint32_t>(table.whole_number("sync_id", 0x80, 0));
  can.hardware_stamp_point = read_stamp_point(table);
  can.hardware_tick_s = optional_positive(table, "hardware_tick_s").value_or(can.hardware_tick_s);
  can.correct_frame_duration = table.yes_no("frame_duration_correction", true);
  can.bus_is_shared = table.yes_no("bus_is_shared", true);
  can.latency_s = table.number("latency_s", 0.0, "seconds");
  can.u_latency_s = uncertainty(table, "u_latency_s");
  can.u_utc_s = uncertainty(table, "u_utc_s");
  can.restart_after_bus_off_s = optional_positive(table, "restart_after_bus_off_s");
  if (!can.log.empty()) {
    can.play_speed = read_play_speed(table);
  }
  return can;
}

} // namespace dyncal::inline bench
