#include "services/bench/triggered_source.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "services/bench/dso_delay_file.hpp"

namespace dyncal::services {
namespace {

void require_driver(TomlTable& table, const char* key, const std::vector<SourceSettings>& sources,
                    const std::string& name, SourceDriver driver, const char* word) {
  const auto source = std::find_if(sources.begin(), sources.end(),
                                   [&](const SourceSettings& one) { return one.name == name; });
  if (source != sources.end() && source->driver != driver) {
    table.refuse(key,
                 fmt::format("names source '{}', which must have driver = \"{}\"", name, word));
  }
}

void read_place(TomlTable& table, const std::filesystem::path& folder, SourceSettings& source,
                const char* what) {
  source.address = table.text("address");
  const std::string path = table.text("path");
  if (source.address.empty() == path.empty()) {
    table.refuse("address", fmt::format("or 'path' must be given, one of them: {}", what));
  }
  if (!path.empty()) {
    source.path = std::filesystem::absolute(folder / path).lexically_normal();
  }
}

} // namespace

void read_oscilloscope_source(TomlTable& table, const std::filesystem::path& folder,
                              SourceSettings& source) {
  source.driver = SourceDriver::oscilloscope;
  read_place(table, folder, source,
             "where the oscilloscope answers, or the folder with files of its shots");
  OscilloscopeSourceSettings& oscilloscope = source.oscilloscope;
  oscilloscope.family = table.text("family");
  oscilloscope.sync_input = table.whole_number("sync_input", oscilloscope.sync_input, 1);
  oscilloscope.sync_range_v =
      table.number("sync_range_v", oscilloscope.sync_range_v, "V peak to peak");
  oscilloscope.trigger_level_v = table.number("trigger_level_v", oscilloscope.trigger_level_v, "V");
  if (oscilloscope.sync_range_v <= 0.0) {
    table.refuse("sync_range_v", "must be positive, in V peak to peak");
  }
}

void read_series_source(TomlTable& table, const std::filesystem::path& folder,
                        SourceSettings& source) {
  source.driver = SourceDriver::series;
  read_place(table, folder, source,
             "where the sensor sends its series, or the folder it writes them into");
}

void read_shots(TomlTable& table, const std::vector<SourceSettings>& sources,
                MethodSettings& method) {
  constexpr int max_shots = 1000;
  method.shots = table.whole_number("shots", method.shots, 1);
  if (method.shots > max_shots) {
    table.refuse("shots", fmt::format("must be {} at most", max_shots));
  }
  method.trigger_phase_correction =
      table.yes_no("trigger_phase_correction", method.trigger_phase_correction);
  require_driver(table, "sync_dso", sources, method.sync_dau.source, SourceDriver::oscilloscope,
                 "oscilloscope");
  if (method.dut.empty()) {
    table.refuse(
        "dut",
        "is missing: the channels of the time series sensor, for example [\"tss/acceleration_z\"]");
    return;
  }
  for (const ChannelName& channel : method.dut) {
    require_driver(table, "dut", sources, channel.source, SourceDriver::series, "series");
    if (channel.source != method.dut.front().source) {
      table.refuse(
          "dut",
          "names channels of two sources: series time stamping calibrates one sensor at a time");
    }
  }
}

void read_trigger_delay(TomlTable& table, const std::filesystem::path& folder,
                        CorrectionSettings& corrections) {
  if (!table.has("file")) {
    corrections.dso_delay_s = table.number("value_s", 0.0, "seconds");
    corrections.u_dso_delay_s = table.number("u_s", 0.0, "seconds");
  } else if (table.has("value_s") || table.has("u_s")) {
    table.refuse("file", "is given beside value_s or u_s; the file says both");
  } else {
    const auto delay = read_dso_delay_file(folder / table.required_text("file"));
    if (delay) {
      corrections.dso_delay_s = delay->value_s;
      corrections.u_dso_delay_s = delay->u_s;
    } else {
      table.refuse("file", delay.error().message);
    }
  }
  if (corrections.u_dso_delay_s < 0.0) {
    table.refuse("u_s", "is a standard uncertainty and must not be negative");
  }
  table.finish();
}

} // namespace dyncal::services
