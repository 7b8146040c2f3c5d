#include "services/bench/file/bench_file.hpp"

#include <algorithm>
#include <fstream>
#include <numbers>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "services/bench/file/bench_name.hpp"
#include "services/bench/file/bench_tables.hpp"
#include "services/bench/file/check_table.hpp"
#include "services/bench/file/conditions_table.hpp"
#include "services/bench/file/multisine_keys.hpp"
#include "services/bench/file/run_end_table.hpp"
#include "services/bench/file/sensitivity_keys.hpp"
#include "services/bench/file/toml_lines.hpp"
#include "services/bench/file/toml_text.hpp"
#include "services/contract/digest.hpp"

namespace dyncal::inline bench {
namespace {

constexpr std::size_t max_bytes = std::size_t{4} << 20U;

NetworkSettings read_network(TomlTable table) {
  NetworkSettings network;
  network.peers = table.texts("peers");
  network.multicast = table.yes_no("multicast", true);
  network.interface_name = table.text("interface");
  table.finish();
  return network;
}

// Standard uncertainties above these are taken for another unit.
constexpr double largest_relative = 0.5;
constexpr double largest_phase_rad = std::numbers::pi / 2.0;
constexpr double largest_rate_rel = 0.01;
constexpr double largest_delay_s = 1.0;

UncertaintySettings read_uncertainty(TomlTable table) {
  UncertaintySettings uncertainty;
  const auto read = [&](const char* key, const char* unit, double largest, const char* question,
                        double otherwise = 0.0) {
    const double value = table.number(key, otherwise, unit);
    if (value < 0.0) {
      table.refuse(key, "is a standard uncertainty and must not be negative");
    } else if (!(value <= largest)) {
      table.refuse(key, fmt::format("= {:g} is not plausible: a standard uncertainty in {} above "
                                    "{:.3g}; {}",
                                    value, unit, largest, question));
    }
    return value;
  };
  const char* const percent = "is it given in per cent?";
  const char* const ppm = "is it given in parts per million?";
  const char* const other_unit = "is it given in microseconds or nanoseconds?";
  uncertainty.reference_magnitude_rel =
      read("reference_magnitude_rel", "parts of the magnitude", largest_relative, percent);
  uncertainty.reference_phase_rad =
      read("reference_phase_rad", "rad", largest_phase_rad, "is it given in degrees?");
  uncertainty.acs_delay_s = read("acs_delay_s", "seconds", largest_delay_s, other_unit);
  uncertainty.monte_carlo_trials =
      static_cast<std::uint64_t>(table.whole_number("monte_carlo_trials", 0, 0));
  uncertainty.acs_rate_rel = read("acs_rate_rel", "parts of the rate", largest_rate_rel, ppm);
  uncertainty.dso_rate_rel =
      read("dso_rate_rel", "parts of the rate", largest_rate_rel, ppm, default_dso_rate_rel);
  uncertainty.adc_delay_s = read("adc_delay_s", "seconds", largest_delay_s, other_unit);
  table.finish();
  return uncertainty;
}

std::optional<TomlTable> required_table(TomlTable& root, const std::string& key) {
  auto found = root.table(key);
  if (!found) {
    root.refuse(key, "is missing: the bench file needs this table");
  }
  return found;
}

BenchFile read_tables(const toml::table& parsed, const std::filesystem::path& path,
                      NamedFiles::Place place, BenchProblems& problems) {
  BenchFile file;
  NamedFiles files(std::filesystem::absolute(path).parent_path(), place);
  TomlTable root(parsed, "", path.string(), problems);
  file.bench = root.required_text("bench");
  check_name(root, "bench", file.bench);
  file.sensor = line_of(root, "sensor");
  if (auto network = root.table("network")) {
    file.network = read_network(std::move(*network));
  }
  if (auto excitation = required_table(root, "excitation")) {
    file.excitation = read_excitation(std::move(*excitation));
  }
  if (auto generator = root.table("generator")) {
    file.generator = read_generator(std::move(*generator), file.excitation);
  }
  if (auto sources = required_table(root, "sources")) {
    file.sources = read_sources(std::move(*sources), files);
    if (file.sources.empty()) {
      root.refuse("sources", "holds no source: a bench needs its instruments as [sources.NAME]");
    }
  }
  if (auto method = required_table(root, "method")) {
    file.method = read_method(std::move(*method), file.sources);
  }
  if (auto excitation = root.table("excitation")) {
    check_multisine(std::move(*excitation), file);
  }
  if (auto generator = root.table("generator")) {
    check_generator(std::move(*generator), file);
  }
  if (auto corrections = root.table("corrections")) {
    file.corrections = read_corrections(std::move(*corrections), files);
  }
  if (auto sources = root.table("sources")) {
    assign_sensitivities(std::move(*sources), file);
  }
  if (auto uncertainty = root.table("uncertainty")) {
    if (file.corrections.adc && uncertainty->has("adc_delay_s")) {
      uncertainty->refuse("adc_delay_s", "is for a sync ADC without calibration, but "
                                         "corrections.adc names one, which has its own");
    }
    file.uncertainty = read_uncertainty(std::move(*uncertainty));
  }
  static_cast<void>(read_check(root)); // by who conducts a run, of its text, as those below
  static_cast<void>(read_condition_settings(root));
  static_cast<void>(read_run_end(root));
  root.finish();
  file.named_files = files.all();
  return file;
}

// Or why there is none.
tl::expected<std::string, std::string> read_text(const std::filesystem::path& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) {
    return tl::unexpected<std::string>("is a folder; name the bench file in it");
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text(stream ? max_bytes + 1 : 0, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  const auto length = static_cast<std::size_t>(stream.gcount());
  if (length > max_bytes) {
    return tl::unexpected<std::string>(
        "has more than 4 MiB, which no bench file needs; is it another file?");
  }
  if (!stream.eof()) {
    return tl::unexpected<std::string>(
        "cannot read this bench file; does it exist, and may you read it?");
  }
  text.resize(length);
  return text;
}

Expected<BenchFile> valid(BenchFileReading reading) {
  if (!reading.problems.empty()) {
    return fail(ErrorCode::bad_file, reading.problems.front().text());
  }
  return std::move(reading.file);
}

} // namespace

const SourceSettings* BenchFile::source(const std::string& name) const {
  const auto found = std::ranges::find(sources, name, &SourceSettings::name);
  return found == sources.end() ? nullptr : &*found;
}

BenchFileReading parse_whole_bench_file(const std::string& text, const std::filesystem::path& path,
                                        NamedFiles::Place place) {
  BenchFileReading reading;
  BenchFile& file = reading.file;
  if (const auto parsed = parse_toml(text, path)) {
    file = read_tables(*parsed, path, place, reading.problems);
  } else {
    reading.problems.push_back(parsed.error());
  }
  file.path = path;
  file.text = text;
  file.sha256 = sha256_hex(text);
  for (SourceSettings& source : file.sources) {
    source.origin.sha256 = file.sha256;
  }
  return reading;
}

BenchFileReading read_whole_bench_file(const std::filesystem::path& path, NamedFiles::Place place) {
  const auto text = read_text(path);
  if (text) {
    return parse_whole_bench_file(*text, path, place);
  }
  BenchFileReading reading;
  reading.file.path = path;
  reading.problems.push_back({path.string(), BenchProblem::whole_file, "", text.error()});
  return reading;
}

Expected<BenchFile> parse_bench_file(const std::string& text, const std::filesystem::path& path,
                                     NamedFiles::Place place) {
  return valid(parse_whole_bench_file(text, path, place));
}

Expected<BenchFile> read_bench_file(const std::filesystem::path& path, NamedFiles::Place place) {
  return valid(read_whole_bench_file(path, place));
}

} // namespace dyncal::inline bench
