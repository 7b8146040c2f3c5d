#include "services/bench/file/smartup_source.hpp"

#include <charconv>

#include <fmt/core.h>

namespace dyncal::inline bench {

namespace {

std::optional<std::uint32_t> read_sensor_id(TomlTable& table, const std::string& key) {
  const std::string text = table.text(key);
  if (text.empty()) {
    return std::nullopt;
  }
  std::uint32_t id = 0;
  const bool prefixed = text.starts_with("0x") || text.starts_with("0X");
  const char* begin = text.data() + (prefixed ? 2 : 0);
  const auto [end, status] =
      std::from_chars(begin, text.data() + text.size(), id, prefixed ? 16 : 10);
  if (status != std::errc{} || end != text.data() + text.size()) {
    table.refuse(key,
                 fmt::format("is \"{}\" but must be a sensor id such as \"0xbccb0100\"", text));
    return std::nullopt;
  }
  return id;
}

} // namespace

SmartupSourceSettings read_smartup_source(TomlTable& table) {
  SmartupSourceSettings smartup;
  smartup.listen = table.text("listen", "0.0.0.0:7654");
  if (!table.has("sensor")) {
    table.refuse("sensor", "is missing: the id of the sensor, for example \"0xbccb0100\"");
  }
  const auto sensor = read_sensor_id(table, "sensor");
  if (!sensor) {
    table.refuse("sensor", "must not be empty: the id of the sensor, for example \"0xbccb0100\"");
  }
  smartup.sensor = sensor.value_or(0);
  smartup.sync_sensor = read_sensor_id(table, "sync_sensor");
  return smartup;
}

} // namespace dyncal::inline bench
