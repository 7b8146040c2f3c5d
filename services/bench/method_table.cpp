#include "services/bench/method_table.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::services {

namespace {

using Sources = std::vector<SourceSettings>;

constexpr int max_shots = 1000;

ChannelName parse_role(TomlTable& table, const std::string& key, const Sources& sources,
                       const std::string& text) {
  const auto name = parse_channel_name(text);
  if (!name) {
    table.refuse(
        key, fmt::format("is \"{}\" but must be \"source/channel\", for example \"acs/reference\"",
                         text));
    return {};
  }
  if (std::none_of(sources.begin(), sources.end(),
                   [&](const SourceSettings& source) { return source.name == name->source; })) {
    std::vector<std::string> names;
    for (const SourceSettings& source : sources) {
      names.push_back(source.name);
    }
    table.refuse(key, fmt::format("names source '{}', which [sources] does not have (it has: {})",
                                  name->source, fmt::join(names, ", ")));
  }
  return *name;
}

ChannelName read_role(TomlTable& table, const std::string& key, const Sources& sources) {
  return parse_role(table, key, sources, table.required_text(key));
}

void read_dut(TomlTable& table, const Sources& sources, MethodSettings& method) {
  for (const std::string& text : table.texts("dut")) {
    method.dut.push_back(parse_role(table, "dut", sources, text));
  }
}

void require_dut(TomlTable& table) {
  if (table.texts("dut").empty()) {
    table.refuse(
        "dut", "is missing: the channels under calibration, for example [\"can/acceleration_z\"]");
  }
}

// The sync that the ACS records, which shares its clock with the reference.
void require_common_clock(TomlTable& table, const MethodSettings& method) {
  if (method.reference.source != method.sync_acs.source) {
    table.refuse("sync_acs", "must be of the same source as the reference: the two share a clock");
  }
}

template <class Driver>
void require_driver(TomlTable& table, const char* key, const Sources& sources,
                    const std::string& name, const char* driver) {
  const auto source = std::ranges::find(sources, name, &SourceSettings::name);
  if (source != sources.end() && !source->template is<Driver>()) {
    table.refuse(key,
                 fmt::format("names source '{}', which must have driver = \"{}\"", name, driver));
  }
}

void read_analogue(TomlTable& table, const Sources& sources, MethodSettings& method) {
  if (table.has("sync_acs")) {
    method.sync_acs = read_role(table, "sync_acs", sources);
  }
  require_dut(table);
  read_dut(table, sources, method);
  for (const ChannelName& channel : method.dut) {
    if (channel.source != method.reference.source) {
      table.refuse("dut", fmt::format("names \"{}\", but the analogue method compares channels of "
                                      "one system: those of source '{}'",
                                      channel.text(), method.reference.source));
    }
  }
}

void read_absolute_time(TomlTable& table, const Sources& sources, MethodSettings& method) {
  if (table.has("sync_acs")) {
    method.sync_acs = read_role(table, "sync_acs", sources);
  }
  require_dut(table);
  read_dut(table, sources, method);
}

void read_sample_timestamping(TomlTable& table, const Sources& sources, MethodSettings& method) {
  method.sync_acs = read_role(table, "sync_acs", sources);
  method.sync_dau = read_role(table, "sync_dau", sources);
  require_common_clock(table, method);
  read_dut(table, sources, method);
  // A sensor beside the DAU has stamps of its own; they must be of the DAU's time scale, which the
  // analysis sees to.
  const auto beside_dau = [&](const ChannelName& name) {
    return name.source != method.sync_dau.source;
  };
  for (const ChannelName& channel : method.dut) {
    if (beside_dau(channel) != beside_dau(method.dut.front())) {
      table.refuse("dut", fmt::format("names \"{}\" and \"{}\", but the channels must be either "
                                      "all of the source of sync_dau, whose stamps "
                                      "they share, or all of others",
                                      method.dut.front().text(), channel.text()));
    }
  }
}

void read_series_timestamping(TomlTable& table, const Sources& sources, MethodSettings& method) {
  method.sync_acs = read_role(table, "sync_acs", sources);
  method.sync_dau = read_role(table, "sync_dso", sources);
  require_common_clock(table, method);
  read_dut(table, sources, method);
  method.shots = table.whole_number("shots", method.shots, 1);
  if (method.shots > max_shots) {
    table.refuse("shots", fmt::format("must be {} at most", max_shots));
  }
  method.trigger_phase_correction =
      table.yes_no("trigger_phase_correction", method.trigger_phase_correction);
  require_driver<OscilloscopeSourceSettings>(table, "sync_dso", sources, method.sync_dau.source,
                                             "oscilloscope");
  if (method.dut.empty()) {
    table.refuse("dut", "is missing: the channels of the time series sensor, for example "
                        "[\"tss/acceleration_z\"]");
  }
  for (const ChannelName& channel : method.dut) {
    require_driver<SeriesSourceSettings>(table, "dut", sources, channel.source, "series");
    if (channel.source != method.dut.front().source) {
      table.refuse("dut", "names channels of two sources: series time stamping calibrates one "
                          "sensor at a time");
    }
  }
}

void read_roles(TomlTable& table, const std::string& kind, const Sources& sources,
                MethodSettings& method) {
  if (kind == "analogue") {
    method.kind = EvaluationMethod::analogue;
    read_analogue(table, sources, method);
  } else if (kind == "series-timestamping") {
    method.kind = EvaluationMethod::series_timestamping;
    read_series_timestamping(table, sources, method);
  } else if (kind == "absolute-time") {
    method.kind = EvaluationMethod::absolute_time;
    read_absolute_time(table, sources, method);
  } else {
    method.kind = EvaluationMethod::sample_timestamping;
    read_sample_timestamping(table, sources, method);
  }
}

} // namespace

MethodSettings read_method(TomlTable table, const Sources& sources) {
  MethodSettings method;
  const std::string kind = table.one_of(
      "kind", {"analogue", "sample-timestamping", "series-timestamping", "absolute-time"}, "");
  method.reference = read_role(table, "reference", sources);
  read_roles(table, kind, sources, method);
  if (table.has("temperature")) {
    method.temperature = read_role(table, "temperature", sources);
  }
  method.frequency_search_rel =
      table.number("frequency_search_rel", method.frequency_search_rel, "parts of the frequency");
  if (method.frequency_search_rel < 0.0 || method.frequency_search_rel > 0.1) {
    table.refuse("frequency_search_rel",
                 "must be between 0 (the frequency is known exactly in every clock) and 0.1");
  }
  table.finish();
  return method;
}

} // namespace dyncal::services
