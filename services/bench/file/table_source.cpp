#include <cmath>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "services/bench/file/driver_tables.hpp"

namespace dyncal::inline bench {
namespace {

using namespace drivers::tables;

constexpr int max_first_loop = 1'000'000'000;

template <class Enum, std::size_t count>
std::optional<Enum> read_word(TomlTable& table, const char* key, const Enum (&values)[count],
                              const std::string& otherwise) {
  std::vector<std::string> words;
  for (const Enum value : values) {
    words.emplace_back(to_string(value));
  }
  const std::string chosen = table.one_of(key, words, otherwise);
  for (const Enum value : values) {
    if (chosen == to_string(value)) {
      return value;
    }
  }
  return std::nullopt;
}

void read_paths(TomlTable& table, NamedFiles& files, TableSettings& settings) {
  const toml::node* node = table.node("path");
  const std::vector<std::string> texts = node != nullptr && node->is_array()
                                             ? table.texts("path")
                                             : std::vector{table.required_text("path")};
  for (const std::string& text : texts) {
    settings.paths.push_back(files.resolve(text));
  }
  if (texts.empty()) {
    table.refuse("path", "must name a file, files of one loop each, or their folder");
  }
}

// Above 0 and finite.
std::optional<double> read_above_0(TomlTable& table, const char* key, const char* unit) {
  const auto value = table.optional_number(key, unit);
  if (value && !(*value > 0.0 && std::isfinite(*value))) {
    table.refuse(key, "must be above 0");
  }
  return value;
}

} // namespace

TableSourceSettings read_table_source(TomlTable& table, NamedFiles& files) {
  TableSourceSettings settings;
  read_paths(table, files, settings);
  if (table.has("format")) {
    constexpr TableFormat formats[] = {TableFormat::ptb_csv, TableFormat::spektra_csv,
                                       TableFormat::spektra_prp};
    settings.format = read_word(table, "format", formats, "");
  }
  constexpr TablePhase phases[] = {TablePhase::sync_minus_reference,
                                   TablePhase::reference_minus_sync};
  if (!table.has("phase")) {
    table.refuse("phase", "is missing: whether the table's phase is \"sync-minus-reference\" or "
                          "\"reference-minus-sync\"; the wrong one turns the phase of every "
                          "result, so there is no usual one");
  }
  settings.phase = read_word(table, "phase", phases, "").value_or(settings.phase);
  constexpr TableAmplitude amplitudes[] = {TableAmplitude::peak, TableAmplitude::rms};
  settings.amplitude =
      read_word(table, "amplitude", amplitudes, "peak").value_or(settings.amplitude);
  settings.phase_offset_deg = table.number("phase_offset_deg", 0.0, "degrees");
  if (!(std::abs(settings.phase_offset_deg) <= 360.0)) {
    table.refuse("phase_offset_deg", "must be from -360 to 360, in degrees");
  }
  settings.coverage = read_above_0(table, "coverage", "standard uncertainties");
  settings.u_amplitude_rel = read_above_0(table, "u_amplitude_rel", "parts of the amplitude");
  settings.u_phase_deg = read_above_0(table, "u_phase_deg", "degrees");
  if (table.has("first_loop")) {
    settings.first_loop = table.whole_number("first_loop", 0, 0);
    if (*settings.first_loop > max_first_loop) {
      table.refuse("first_loop", "must be the number of a loop");
    }
  }
  settings.skip_first_rows = static_cast<std::size_t>(table.whole_number("skip_first_rows", 0, 0));
  settings.skip_last_rows = static_cast<std::size_t>(table.whole_number("skip_last_rows", 0, 0));
  return settings;
}

} // namespace dyncal::inline bench
