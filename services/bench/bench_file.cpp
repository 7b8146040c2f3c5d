#include "services/bench/bench_file.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/bench/can_source.hpp"
#include "services/bench/excitation_table.hpp"
#include "services/bench/generator_table.hpp"
#include "services/bench/toml_table.hpp"
#include "services/bench/triggered_source.hpp"
#include "services/contract/digest.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::services {
namespace {

constexpr std::size_t max_key = 64; // of the contract's key strings

void check_name(TomlTable& table, const std::string& key, const std::string& name) {
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (!plain || name.size() > max_key) {
    table.refuse(
        key, fmt::format(
                 "is \"{}\" but a name may hold letters, digits, '-', '_' and '.', {} at the most",
                 name, max_key));
  }
}

NetworkSettings read_network(TomlTable table) {
  NetworkSettings network;
  network.peers = table.texts("peers");
  network.multicast = table.yes_no("multicast", true);
  network.interface_name = table.text("interface");
  table.finish();
  return network;
}

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

void read_play(TomlTable& table, SourceSettings& source) {
  const toml::node* play = table.node("play");
  if (play == nullptr) {
    return;
  }
  if (play->is_number()) {
    source.play_speed = table.number("play", 1.0, "");
    if (source.play_speed <= 0.0) {
      table.refuse("play", "must be positive: 10.0 plays ten times faster than real time");
    }
    return;
  }
  source.play_speed =
      table.one_of("play", {"at-once", "real-time"}, "at-once") == "real-time" ? 1.0 : 0.0;
}

void read_units(TomlTable& table, SourceSettings& source) {
  for (const auto& [channel, unit] : table.text_map("units")) {
    if (const auto d_si = to_d_si(unit)) {
      source.units.emplace(channel, *d_si);
    } else {
      table.refuse("units", fmt::format("gives channel '{}' the unit \"{}\", which is neither D-SI "
                                        "nor a known short form such as \"m/s^2\" or \"V\"",
                                        channel, unit));
    }
  }
}

void read_smartup(TomlTable& table, SourceSettings& source) {
  source.driver = SourceDriver::smartup;
  source.listen = table.text("listen", "0.0.0.0:7654");
  if (!table.has("sensor")) {
    table.refuse("sensor", "is missing: the id of the sensor, for example \"0xbccb0100\"");
  }
  source.sensor = read_sensor_id(table, "sensor");
  source.sync_sensor = read_sensor_id(table, "sync_sensor");
}

void read_file_source(TomlTable& table, const std::filesystem::path& folder,
                      SourceSettings& source) {
  source.driver = SourceDriver::file;
  const std::string path = table.required_text("path");
  source.path = std::filesystem::absolute(folder / path).lexically_normal();
  if (!path.empty() && !std::filesystem::is_regular_file(source.path)) {
    table.refuse("path", fmt::format("names {}, which does not exist or is not a file",
                                     source.path.string()));
  }
  read_play(table, source);
  source.sample_rate_hz = table.optional_number("sample_rate_hz", "Hz");
  if (source.sample_rate_hz && *source.sample_rate_hz <= 0.0) {
    table.refuse("sample_rate_hz", "must be positive, in Hz");
  }
}

SourceSettings read_source(TomlTable table, const std::string& name,
                           const std::filesystem::path& folder) {
  SourceSettings source;
  source.name = name;
  source.where = table.where("driver");
  const std::string driver =
      table.one_of("driver", {"smartup", "socket", "file", "can", "oscilloscope", "series"}, "");
  if (driver == "smartup") {
    read_smartup(table, source);
  } else if (driver == "socket") {
    source.driver = SourceDriver::socket;
    source.address = table.required_text("address");
  } else if (driver == "file") {
    read_file_source(table, folder, source);
  } else if (driver == "can") {
    read_can_source(table, folder, source);
    if (!source.can->log.empty()) {
      read_play(table, source);
    }
  } else if (driver == "oscilloscope") {
    read_oscilloscope_source(table, folder, source);
  } else if (driver == "series") {
    read_series_source(table, folder, source);
  }
  source.channels = table.text_map("channels");
  read_units(table, source);
  if (source.can) {
    source.can->sensor.channels = source.channels;
    source.can->sensor.units = source.units;
  }
  const std::string usual = driver == "smartup" || driver == "can" ? "utc" : "local";
  source.time_base = table.one_of("time_base", {"utc", "local"}, usual) == "utc"
                         ? drivers::TimeBase::utc
                         : drivers::TimeBase::local;
  if (source.can) {
    source.can->sensor.time_base = source.time_base;
  }
  table.finish();
  return source;
}

std::vector<SourceSettings> read_sources(TomlTable table, const std::filesystem::path& folder) {
  std::vector<SourceSettings> sources;
  for (const std::string& name : table.keys()) {
    check_name(table, name, name);
    if (auto inner = table.table(name)) {
      sources.push_back(read_source(std::move(*inner), name, folder));
    }
  }
  return sources;
}

ChannelName read_role(TomlTable& table, const std::string& key,
                      const std::vector<SourceSettings>& sources, const std::string& text) {
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

EvaluationMethod method_of(const std::string& word) {
  if (word == "analogue") {
    return EvaluationMethod::analogue;
  }
  if (word == "series-timestamping") {
    return EvaluationMethod::series_timestamping;
  }
  return word == "absolute-time" ? EvaluationMethod::absolute_time
                                 : EvaluationMethod::sample_timestamping;
}

MethodSettings read_method(TomlTable table, const std::vector<SourceSettings>& sources) {
  MethodSettings method;
  method.kind = method_of(table.one_of(
      "kind", {"analogue", "sample-timestamping", "series-timestamping", "absolute-time"}, ""));
  method.reference = read_role(table, "reference", sources, table.required_text("reference"));
  const bool analogue = method.kind == EvaluationMethod::analogue;
  const bool without_sync = analogue || method.kind == EvaluationMethod::absolute_time;
  if (!without_sync || table.has("sync_acs")) {
    method.sync_acs = read_role(table, "sync_acs", sources, table.required_text("sync_acs"));
  }
  const bool stamped = method.kind == EvaluationMethod::sample_timestamping;
  const bool by_series = method.kind == EvaluationMethod::series_timestamping;
  if (stamped || by_series) {
    const char* sync = stamped ? "sync_dau" : "sync_dso";
    method.sync_dau = read_role(table, sync, sources, table.required_text(sync));
    if (method.reference.source != method.sync_acs.source) {
      table.refuse("sync_acs",
                   "must be of the same source as the reference: the two share a clock");
    }
  }
  if (without_sync && table.texts("dut").empty()) {
    table.refuse(
        "dut", "is missing: the channels under calibration, for example [\"can/acceleration_z\"]");
  }
  for (const std::string& text : table.texts("dut")) {
    method.dut.push_back(read_role(table, "dut", sources, text));
    if (analogue && method.dut.back().source != method.reference.source) {
      table.refuse("dut", fmt::format("names \"{}\", but the analogue method compares channels of "
                                      "one system: those of source '{}'",
                                      text, method.reference.source));
    }
    // A sensor beside the DAU has stamps of its own; they must be of the DAU's time scale, which
    // the analysis sees to.
    const auto beside = [&](const ChannelName& name) {
      return name.source != method.sync_dau.source;
    };
    if (stamped && beside(method.dut.back()) != beside(method.dut.front())) {
      table.refuse("dut", fmt::format("names \"{}\" and \"{}\", but the channels must be either "
                                      "all of the source of sync_dau, whose stamps "
                                      "they share, or all of others",
                                      method.dut.front().text(), text));
    }
  }
  if (by_series) {
    read_shots(table, sources, method);
  }
  if (table.has("temperature")) {
    method.temperature =
        read_role(table, "temperature", sources, table.required_text("temperature"));
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

CorrectionSettings read_corrections(TomlTable table, const std::filesystem::path& folder) {
  CorrectionSettings corrections;
  if (auto adc = table.table("adc")) {
    AdcCorrectionSettings settings;
    const std::string file = adc->required_text("file");
    settings.file = std::filesystem::absolute(folder / file).lexically_normal();
    if (!file.empty() && !std::filesystem::is_regular_file(settings.file)) {
      adc->refuse("file", fmt::format("names {}, which does not exist or is not a file",
                                      settings.file.string()));
    }
    settings.channel = adc->required_text("channel");
    settings.phase_sign = adc->one_of("phase_sign", {"lag", "lead"}, "lag") == "lag"
                              ? PhaseSign::lag
                              : PhaseSign::lead;
    settings.test_amplitude_vpp = adc->optional_number("test_amplitude_vpp", "V peak to peak");
    adc->finish();
    corrections.adc = settings;
  }
  corrections.reference_delay_s = table.number("reference_delay_s", 0.0, "seconds");
  if (auto delay = table.table("dso_delay")) {
    read_trigger_delay(*delay, folder, corrections);
  }
  table.finish();
  return corrections;
}

UncertaintySettings read_uncertainty(TomlTable table) {
  UncertaintySettings uncertainty;
  const auto read = [&](const char* key, const char* unit) {
    const double value = table.number(key, 0.0, unit);
    if (value < 0.0) {
      table.refuse(key, "is a standard uncertainty and must not be negative");
    }
    return value;
  };
  uncertainty.reference_magnitude_rel = read("reference_magnitude_rel", "parts of the magnitude");
  uncertainty.reference_phase_rad = read("reference_phase_rad", "rad");
  uncertainty.acs_delay_s = read("acs_delay_s", "seconds");
  uncertainty.monte_carlo_trials =
      static_cast<std::uint64_t>(table.whole_number("monte_carlo_trials", 0, 0));
  uncertainty.acs_rate_rel = read("acs_rate_rel", "parts of the rate");
  table.finish();
  return uncertainty;
}

TomlTable required_table(TomlTable& root, const std::string& key) {
  static const toml::table nothing;
  if (auto found = root.table(key)) {
    return std::move(*found);
  }
  root.refuse(key, "is missing: the bench file needs this table");
  static std::string ignored;
  return TomlTable(nothing, key, "", ignored);
}

BenchFile read_tables(const toml::table& parsed, const std::filesystem::path& path,
                      std::string& problem) {
  BenchFile file;
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  TomlTable root(parsed, "", path.string(), problem);
  file.bench = root.required_text("bench");
  check_name(root, "bench", file.bench);
  if (auto network = root.table("network")) {
    file.network = read_network(std::move(*network));
  }
  file.excitation = read_excitation(required_table(root, "excitation"));
  file.generator.driver = "none";
  if (auto generator = root.table("generator")) {
    file.generator = read_generator(std::move(*generator), file.excitation);
  }
  file.sources = read_sources(required_table(root, "sources"), folder);
  file.method = read_method(required_table(root, "method"), file.sources);
  if (auto corrections = root.table("corrections")) {
    file.corrections = read_corrections(std::move(*corrections), folder);
  }
  if (auto uncertainty = root.table("uncertainty")) {
    file.uncertainty = read_uncertainty(std::move(*uncertainty));
  }
  root.finish();
  return file;
}

} // namespace

const SourceSettings* BenchFile::source(const std::string& name) const {
  const auto found =
      std::find_if(sources.begin(), sources.end(),
                   [&](const SourceSettings& settings) { return settings.name == name; });
  return found == sources.end() ? nullptr : &*found;
}

Expected<BenchFile> parse_bench_file(const std::string& text, const std::filesystem::path& path) {
  std::string problem;
  BenchFile file;
  try {
    const toml::table parsed = toml::parse(text, path.string());
    file = read_tables(parsed, path, problem);
  } catch (const toml::parse_error& error) {
    problem = fmt::format("{}:{}: not valid TOML: {}", path.string(), error.source().begin.line,
                          error.description());
  }
  if (!problem.empty()) {
    return fail(ErrorCode::bad_file, problem);
  }
  file.path = path;
  file.text = text;
  file.sha256 = sha256_hex(text);
  return file;
}

Expected<BenchFile> read_bench_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path)) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot read this bench file; does it exist, and may you read it?",
                            path.string()));
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_bench_file(text.str(), path);
}

} // namespace dyncal::services
