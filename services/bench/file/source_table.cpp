#include "services/bench/file/bench_tables.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include <fmt/core.h>

#include "services/bench/file/acs_drivers.hpp"
#include "services/bench/file/bench_name.hpp"
#include "services/bench/file/driver_tables.hpp"
#include "services/bench/file/interferometer_table.hpp"
#include "services/bench/file/pulses_table.hpp"
#include "services/bench/file/sensitivity_keys.hpp"
#include "services/contract/channel_unit.hpp"

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

// One sensor of a SmartUp Unit:
//
//   listen = "0.0.0.0:7654"        address and UDP port of this host
//   sensor = "0xbccb0100"
//   sync_sensor = "0xbccb0a00"     sensor id that carries the sync ADC of later firmware
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

DriverSettings read_driver(TomlTable& table, const std::string& driver, NamedFiles& files) {
  if (driver == "smartup") {
    return read_smartup_source(table);
  }
  if (driver == "socket") {
    // The TCP stream of an analogue calibration system (drivers/acs/README.md).
    return SocketSourceSettings{.address = table.required_text("address")};
  }
  if (driver == "alsa") {
    return read_alsa_source(table);
  }
  if (driver == "can") {
    return read_can_source(table, files);
  }
  if (driver == "oscilloscope") {
    return read_oscilloscope_source(table, files);
  }
  if (driver == "series") {
    return read_series_source(table, files);
  }
  if (driver == "table") {
    return read_table_source(table, files);
  }
  if (const auto* registered = acs_driver_named(driver)) {
    return read_acs_source(table, *registered);
  }
  return driver == "file" ? read_file_source(table, files) : FileSourceSettings{};
}

void read_units(TomlTable& table, SourceSettings& source) {
  std::size_t entry = 0;
  for (const auto& [channel, unit] : table.text_map("units")) {
    ++entry;
    const auto parsed = parse_channel_unit(unit);
    if (!parsed) {
      table.refuse_entry("units", entry,
                         fmt::format("gives channel '{}' the unit \"{}\", which {}", channel, unit,
                                     parsed.error().message));
    } else if (parsed->is_conversion()) {
      source.identity.units.emplace(channel, *parsed);
    } else {
      source.units.emplace(channel, parsed->d_si);
    }
  }
}

// "none", or "LOW to HIGH".
std::optional<StatedRange> range_of(const std::string& text) {
  constexpr std::string_view word = " to ";
  const std::size_t place = text.find(word);
  if (text == "none") {
    return StatedRange{};
  }
  if (place == std::string::npos) {
    return std::nullopt;
  }
  StatedRange range;
  const auto read = [](std::string_view number, double& value) {
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    return error == std::errc() && end == number.data() + number.size() && std::isfinite(value);
  };
  const std::string_view whole = text;
  return read(whole.substr(0, place), range.minimum) &&
                 read(whole.substr(place + word.size()), range.maximum) &&
                 range.minimum < range.maximum
             ? std::optional(range)
             : std::nullopt;
}

void read_ranges(TomlTable& table, SourceSettings& source) {
  std::size_t entry = 0;
  for (const auto& [channel, text] : table.text_map("ranges")) {
    ++entry;
    if (const auto range = range_of(text)) {
      const auto unit = source.identity.units.find(channel);
      const double named = unit == source.identity.units.end() ? 1.0 : unit->second.named;
      source.identity.ranges.emplace(channel,
                                     StatedRange{named * range->minimum, named * range->maximum});
    } else {
      table.refuse_entry("ranges", entry,
                         fmt::format("gives channel '{}' the range \"{}\", which is neither "
                                     "\"none\" nor two rising numbers such as \"-20 to 20\"",
                                     channel, text));
    }
  }
}

SourceSettings read_source(TomlTable table, const std::string& name, NamedFiles& files) {
  SourceSettings source;
  source.name = name;
  source.where = table.where("driver");
  std::vector<std::string> words{"smartup", "socket",       "alsa",   "file",
                                 "can",     "oscilloscope", "series", "table"};
  for (const drivers::AcsDriver* registered : acs_drivers()) {
    words.emplace_back(registered->name);
  }
  const std::string driver = table.one_of("driver", words, "");
  source.driver = read_driver(table, driver, files);
  source.identity = {.device = table.text("device"),
                     .serial = table.text("serial"),
                     .firmware = table.text("firmware")};
  source.channels = table.text_map("channels");
  if (driver == "smartup" || driver == "socket") { // others have a rate of their own
    source.nominal_rate_hz = table.optional_number("nominal_rate_hz", "Hz");
    if (source.nominal_rate_hz && *source.nominal_rate_hz <= 0.0) {
      table.refuse("nominal_rate_hz", "must be positive, in Hz");
    }
  }
  if (const auto* alsa = source.as<AlsaSourceSettings>()) {
    source.nominal_rate_hz = alsa->rate_hz;
  }
  const auto* acs = source.as<AcsSourceSettings>();
  if (acs != nullptr && acs->numbers.contains("sample_rate_hz")) {
    source.nominal_rate_hz = acs->numbers.at("sample_rate_hz");
  }
  read_units(table, source);
  if (driver == "file" || driver == "socket" || driver == "alsa" || acs != nullptr) {
    read_sensitivities(table, files, source);
  }
  read_ranges(table, source);
  if (driver == "socket" || driver == "alsa") {
    source.pulses = read_pulses(table);
  }
  const bool is_usually_utc = driver == "smartup" || driver == "can" || source.pulses;
  const std::string usual = is_usually_utc ? "utc" : "local";
  if (driver == "file" || driver == "socket" || driver == "alsa") {
    read_interferometer(table, files, source);
  }
  source.time_base = table.one_of("time_base", {"utc", "local"}, usual) == "utc"
                         ? drivers::TimeBase::utc
                         : drivers::TimeBase::local;
  if (source.pulses && source.time_base == drivers::TimeBase::local) {
    table.refuse("time_base", "is \"local\", but the pulses give the samples UTC: leave it out");
  }
  // What changes no sample is left out: how fast a file is played, and a rate to check against.
  source.origin.settings = table.lines_without(
      source.is<CanSourceSettings>() ? std::set<std::string>{"play"}
                                     : std::set<std::string>{"play", "nominal_rate_hz"});
  table.finish();
  return source;
}

} // namespace

std::vector<SourceSettings> read_sources(TomlTable table, NamedFiles& files) {
  std::vector<SourceSettings> sources;
  for (const std::string& name : table.keys()) {
    check_name(table, name, name);
    if (auto inner = table.table(name)) {
      sources.push_back(read_source(std::move(*inner), name, files));
    }
  }
  return sources;
}

} // namespace dyncal::inline bench
