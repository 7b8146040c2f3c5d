#include "services/bench/can_source.hpp"

#include <charconv>
#include <cstdint>
#include <string>

#include <fmt/format.h>

namespace dyncal::services {

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
  const std::string word = table.one_of(
      "time_source",
      {"best", "canopen-sync", "payload-time", "counter", "hardware-stamp", "kernel-stamp"},
      "best");
  for (const TimeSource source :
       {TimeSource::canopen_sync, TimeSource::payload_time, TimeSource::counter,
        TimeSource::hardware_stamp, TimeSource::kernel_stamp}) {
    if (word == drivers::can::to_string(source)) {
      return source;
    }
  }
  return std::nullopt;
}

std::filesystem::path read_file_name(TomlTable& table, const std::string& key,
                                     const std::string& name, const std::filesystem::path& folder) {
  if (name.empty()) {
    return {};
  }
  const auto path = std::filesystem::absolute(folder / name).lexically_normal();
  if (!std::filesystem::is_regular_file(path)) {
    table.refuse(key,
                 fmt::format("names {}, which does not exist or is not a file", path.string()));
  }
  return path;
}

StampPoint read_stamp_point(TomlTable& table) {
  const std::string word = table.one_of("hardware_stamp_point",
                                        {"start-of-frame", "end-of-frame", "unknown"}, "unknown");
  if (word == "start-of-frame") {
    return StampPoint::start_of_frame;
  }
  return word == "end-of-frame" ? StampPoint::end_of_frame : StampPoint::unknown;
}

} // namespace

void read_can_source(TomlTable& table, const std::filesystem::path& folder,
                     SourceSettings& source) {
  source.driver = SourceDriver::can;
  CanSourceSettings& can = source.can.emplace();
  can.log = read_file_name(table, "log", table.text("log"), folder);
  can.interface_name = can.log.empty() ? table.required_text("interface") : table.text("interface");
  can.dbc = read_file_name(table, "dbc", table.required_text("dbc"), folder);
  drivers::can::SensorSettings& sensor = can.sensor;
  sensor.messages = table.texts("messages");
  sensor.time_source = read_time_source(table);
  sensor.counter = table.text("counter");
  sensor.time_field = table.text("time_field");
  sensor.time_field_tick_s = positive(table, "time_field_tick_s", "seconds");
  sensor.nominal_rate_hz = positive(table, "nominal_rate_hz", "Hz");
  sensor.bit_rates.nominal_per_s = positive(table, "bit_rate_per_s", "bit/s");
  sensor.bit_rates.data_per_s = positive(table, "data_bit_rate_per_s", "bit/s");
  sensor.sync_id = static_cast<std::uint32_t>(table.whole_number("sync_id", 0x80, 0));
  sensor.hardware_stamp_point = read_stamp_point(table);
  if (const double tick_s = positive(table, "hardware_tick_s", "seconds"); tick_s > 0.0) {
    sensor.hardware_tick_s = tick_s;
  }
  sensor.correct_frame_duration = table.yes_no("frame_duration_correction", true);
  sensor.bus_is_shared = table.yes_no("bus_is_shared", true);
  sensor.latency_s = table.number("latency_s", 0.0, "seconds");
  sensor.u_latency_s = uncertainty(table, "u_latency_s");
  sensor.u_utc_s = uncertainty(table, "u_utc_s");
  if (const double after_s = positive(table, "restart_after_bus_off_s", "seconds"); after_s > 0.0) {
    can.restart_after_bus_off_s = after_s;
  }
}

} // namespace dyncal::services
