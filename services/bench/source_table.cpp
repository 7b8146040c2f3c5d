#include "services/bench/source_table.hpp"

#include <set>

#include <fmt/core.h>

#include "services/bench/bench_name.hpp"
#include "services/bench/can_source.hpp"
#include "services/bench/file_source.hpp"
#include "services/bench/oscilloscope_source.hpp"
#include "services/bench/series_source.hpp"
#include "services/bench/smartup_source.hpp"
#include "services/bench/socket_source.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::services {

namespace {

DriverSettings read_driver(TomlTable& table, const std::string& driver, NamedFiles& files) {
  if (driver == "smartup") {
    return read_smartup_source(table);
  }
  if (driver == "socket") {
    return read_socket_source(table);
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
  return driver == "file" ? read_file_source(table, files) : FileSourceSettings{};
}

void read_units(TomlTable& table, SourceSettings& source) {
  std::size_t entry = 0;
  for (const auto& [channel, unit] : table.text_map("units")) {
    ++entry;
    if (const auto d_si = to_d_si(unit)) {
      source.units.emplace(channel, *d_si);
    } else {
      table.refuse_entry(
          "units", entry,
          fmt::format("gives channel '{}' the unit \"{}\", which is neither D-SI nor a known short "
                      "form such as \"m/s^2\" or \"V\"",
                      channel, unit));
    }
  }
}

SourceSettings read_source(TomlTable table, const std::string& name, NamedFiles& files) {
  SourceSettings source;
  source.name = name;
  source.where = table.where("driver");
  const std::string driver =
      table.one_of("driver", {"smartup", "socket", "file", "can", "oscilloscope", "series"}, "");
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
  read_units(table, source);
  const std::string usual = driver == "smartup" || driver == "can" ? "utc" : "local";
  source.time_base = table.one_of("time_base", {"utc", "local"}, usual) == "utc"
                         ? drivers::TimeBase::utc
                         : drivers::TimeBase::local;
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

} // namespace dyncal::services
