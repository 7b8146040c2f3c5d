#include "services/bench/file/driver_tables.hpp"

#include <fmt/core.h>

namespace dyncal::inline bench {
namespace {

// `what` explains the two.
void read_address_or_folder(TomlTable& table, NamedFiles& files, const char* what, auto& source) {
  source.address = table.text("address");
  const std::string name = table.text("path");
  if (source.address.empty() == name.empty()) {
    table.refuse("address", fmt::format("or 'path' must be given, one of them: {}", what));
  }
  if (!name.empty()) {
    source.path = files.resolve(name);
  }
}

} // namespace

OscilloscopeSourceSettings read_oscilloscope_source(TomlTable& table, NamedFiles& files) {
  OscilloscopeSourceSettings oscilloscope;
  read_address_or_folder(table, files,
                         "where the oscilloscope answers, or the folder with files of its shots",
                         oscilloscope);
  oscilloscope.family = table.text("family");
  oscilloscope.sync_input = table.whole_number("sync_input", oscilloscope.sync_input, 1);
  oscilloscope.sync_range_v =
      table.number("sync_range_v", oscilloscope.sync_range_v, "V peak to peak");
  oscilloscope.trigger_level_v = table.number("trigger_level_v", oscilloscope.trigger_level_v, "V");
  if (oscilloscope.sync_range_v <= 0.0) {
    table.refuse("sync_range_v", "must be positive, in V peak to peak");
  }
  return oscilloscope;
}

SeriesSourceSettings read_series_source(TomlTable& table, NamedFiles& files) {
  SeriesSourceSettings series;
  read_address_or_folder(
      table, files, "where the sensor sends its series, or the folder it writes them into", series);
  return series;
}

} // namespace dyncal::inline bench
