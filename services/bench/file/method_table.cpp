#include "services/bench/file/bench_tables.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/per_enumerator.hpp"
#include "services/contract/role_rules.hpp"

namespace dyncal::inline bench {

namespace {

using Sources = std::vector<SourceSettings>;

constexpr int max_shots = 1000;

bool is_table(const Sources& sources, const std::string& name) {
  const auto source = std::ranges::find(sources, name, &SourceSettings::name);
  return source != sources.end() && source->is<TableSourceSettings>();
}

// `entry` of a list; the key itself without it.
ChannelName parse_role(TomlTable& table, const std::string& key, const Sources& sources,
                       const std::string& text, std::optional<std::size_t> entry = std::nullopt) {
  const auto refuse = [&](const std::string& what) {
    entry ? table.refuse_entry(key, *entry, what) : table.refuse(key, what);
  };
  const auto name = parse_channel_name(text);
  if (!name) {
    refuse(fmt::format("is \"{}\" but must be \"source/channel\", for example \"acs/reference\"",
                       text));
    return {};
  }
  if (!sources.empty() && // else [sources] was refused
      std::none_of(sources.begin(), sources.end(),
                   [&](const SourceSettings& source) { return source.name == name->source; })) {
    std::vector<std::string> names;
    for (const SourceSettings& source : sources) {
      names.push_back(source.name);
    }
    refuse(fmt::format("names source '{}', which [sources] does not have (it has: {})",
                       name->source, fmt::join(names, ", ")));
    return {}; // what other roles have in common with it cannot be judged
  }
  if (is_table(sources, name->source)) {
    refuse(fmt::format("names source '{}', whose driver is \"table\": it has no samples, and is "
                       "named by reference_table",
                       name->source));
    return {};
  }
  return *name;
}

ChannelName read_role(TomlTable& table, const std::string& key, const Sources& sources) {
  return parse_role(table, key, sources, table.required_text(key));
}

void read_dut(TomlTable& table, const Sources& sources, MethodSettings& method) {
  const std::vector<std::string> names = table.texts("dut");
  for (std::size_t i = 0; i < names.size(); ++i) {
    method.dut.push_back(parse_role(table, "dut", sources, names[i], i));
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

// The methods whose steps are found in the reference's own source.
void read_without_sync(TomlTable& table, const Sources& sources, MethodSettings& method) {
  if (table.has("sync_acs")) {
    method.sync_acs = read_role(table, "sync_acs", sources);
  }
  read_dut(table, sources, method);
}

void read_sample_timestamping(TomlTable& table, const Sources& sources, MethodSettings& method) {
  method.sync_acs = read_role(table, "sync_acs", sources);
  method.sync_dau = read_role(table, "sync_dau", sources);
  read_dut(table, sources, method);
}

void read_series_timestamping(TomlTable& table, const Sources& sources, MethodSettings& method) {
  method.sync_acs = read_role(table, "sync_acs", sources);
  method.sync_dau = read_role(table, "sync_dso", sources);
  read_dut(table, sources, method);
  method.shots = table.whole_number("shots", method.shots, 1);
  if (method.shots > max_shots) {
    table.refuse("shots", fmt::format("must be {} at most", max_shots));
  }
  method.trigger_phase_correction =
      table.yes_no("trigger_phase_correction", method.trigger_phase_correction);
  require_driver<OscilloscopeSourceSettings>(table, "sync_dso", sources, method.sync_dau.source,
                                             "oscilloscope");
  for (const ChannelName& channel : method.dut) {
    require_driver<SeriesSourceSettings>(table, "dut", sources, channel.source, "series");
  }
}

// A source that hands out evaluated steps: reference and sync_acs are names in their messages.
void read_reference_table(TomlTable& table, const Sources& sources, MethodSettings& method) {
  const std::string name = table.required_text("reference_table");
  if (!is_table(sources, name)) {
    table.refuse(
        "reference_table",
        fmt::format("is \"{}\" but must be a source of [sources] with driver = \"table\"", name));
    return;
  }
  for (const char* role : {"reference", "sync_acs"}) {
    if (table.has(role)) {
      static_cast<void>(table.text(role));
      table.refuse(role, "must be left out: reference_table takes its place");
    }
  }
  method.reference = {name, "reference"};
  method.sync_acs = {name, "sync"};
  method.sync_dau = read_role(table, "sync_dau", sources);
  read_dut(table, sources, method);
}

void read_roles(TomlTable& table, const Sources& sources, MethodSettings& method) {
  if (method.kind == EvaluationMethod::sample_timestamping && table.has("reference_table")) {
    read_reference_table(table, sources, method);
    return;
  }
  method.reference = read_role(table, "reference", sources);
  switch (method.kind) {
  case EvaluationMethod::analogue:
  case EvaluationMethod::absolute_time:
    read_without_sync(table, sources, method);
    break;
  case EvaluationMethod::series_timestamping:
    read_series_timestamping(table, sources, method);
    break;
  case EvaluationMethod::sample_timestamping:
    read_sample_timestamping(table, sources, method);
    break;
  }
}

// The rules that a recipe from the bus must keep too.
void check_roles(TomlTable& table, const MethodSettings& method) {
  if (method.reference.source.empty()) {
    return; // it was refused
  }
  const RoleNames roles{.method = method.kind,
                        .reference = method.reference,
                        .sync_acs = method.sync_acs,
                        .sync_sensor = method.sync_dau,
                        .dut = method.dut,
                        .temperature = method.temperature};
  auto problem = find_role_problem(roles);
  if (!problem) {
    problem = find_repeated_channel(roles);
  }
  if (problem && !table.refused(problem->role)) {
    table.refuse(problem->role, problem->sentence);
  }
}

void read_mains(TomlTable& table, MethodSettings& method) {
  method.mains_hz = table.numbers("mains_hz", "Hz");
  if (method.mains_hz.empty() && table.has("mains_hz") && !table.refused("mains_hz")) {
    table.refuse("mains_hz", "must list at least one frequency, as in [16.7, 50]");
  }
  for (std::size_t i = 0; i < method.mains_hz.size(); ++i) {
    if (!(method.mains_hz[i] > 0.0)) {
      table.refuse_entry("mains_hz", i, "must be positive, in Hz");
    }
  }
}

} // namespace

MethodSettings read_method(TomlTable table, const Sources& sources) {
  MethodSettings method;
  const std::string kind = table.one_of("kind", enumerator_texts<EvaluationMethod>(), "");
  method.kind =
      parse_enumerator<EvaluationMethod>(kind).value_or(EvaluationMethod::sample_timestamping);
  read_roles(table, sources, method);
  if (table.has("temperature")) {
    method.temperature = read_role(table, "temperature", sources);
  }
  check_roles(table, method);
  for (const auto& [channel, axis] : table.text_map("axes")) {
    method.axes.push_back({parse_role(table, "axes", sources, channel).text(), axis});
  }
  method.frequency_search_rel =
      table.number("frequency_search_rel", method.frequency_search_rel, "parts of the frequency");
  if (method.frequency_search_rel < 0.0 || method.frequency_search_rel > 0.1) {
    table.refuse("frequency_search_rel",
                 "must be between 0 (the frequency is known exactly in every clock) and 0.1");
  }
  method.clock_tolerance_ppm =
      table.number("clock_tolerance_ppm", method.clock_tolerance_ppm, "parts in a million");
  if (!(method.clock_tolerance_ppm > 0.0 && method.clock_tolerance_ppm <= 1e5)) {
    table.refuse("clock_tolerance_ppm", "must be above 0 and at most 100000");
  }
  const std::string phase =
      table.one_of("dut_phase", enumerator_texts<DutPhase>(), to_string(method.dut_phase));
  method.dut_phase = parse_enumerator<DutPhase>(phase).value_or(method.dut_phase);
  read_mains(table, method);
  table.finish();
  return method;
}

} // namespace dyncal::inline bench
