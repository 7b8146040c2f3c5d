#include "services/programs/command/draft_options.hpp"

#include <cctype>
#include <map>

#include <fmt/core.h>

namespace dyncal::inline programs {
namespace {

using bench_draft::BenchDraft;
using bench_draft::SensorKind;
using Options = std::map<std::string, std::string>; // by key

void add_excitation(const BenchDraft& draft, Options& options) {
  options.insert({{"bench", "--name"},
                  {"excitation.frequencies_hz", "--frequencies"},
                  {"excitation.level", "--level"},
                  {"excitation.repetitions", "--repetitions"},
                  {"excitation.duration_s", "--duration"},
                  {"generator.driver", "--generator"},
                  {"generator.level_per_volt", "--level-per-volt"},
                  {"generator.maximum_voltage_v", "--maximum-voltage"},
                  {"generator.maximum_level_m_s2", "--level"}}); // half as much again
  if (draft.generator == bench_draft::GeneratorKind::scpi) {
    options["generator.address"] = "--generator-address";
  }
}

void add_acs(const BenchDraft& draft, Options& options) {
  options.insert({{"sources.acs.address", "--acs-address"},
                  {"sources.acs.path", "--acs-file"},
                  {"sources.acs.units." + draft.sync, "--sync"},
                  {"sources.acs.units." + draft.reference, "--reference"},
                  {"method.reference", "--reference"},
                  {"method.sync_acs", "--sync"}});
}

void add_sensor(const BenchDraft& draft, Options& options) {
  const std::string channel = channel_of(draft);
  options["method.dut"] = draft.sensor == SensorKind::can ? "--dbc" : "--channel";
  switch (draft.sensor) {
  case SensorKind::smartup:
    options.insert({{"sources.dau.listen", "--listen"}, {"sources.dau.sensor", "--sensor-id"}});
    return;
  case SensorKind::file:
    options.insert({{"sources.dau.path", "--sensor-file"},
                    {"sources.dau.units." + channel, "--channel"},
                    {"sources.dau.units." + draft.sensor_sync, "--sensor-sync"},
                    {"method.sync_dau", "--sensor-sync"}});
    return;
  case SensorKind::can:
    options.insert({{"sources.sensor.interface", "--interface"}, {"sources.sensor.dbc", "--dbc"}});
    return;
  case SensorKind::series:
    options.insert({{"sources.dso.address", "--dso-address"},
                    {"sources.tss.address", "--sensor-address"},
                    {"sources.tss.units." + channel, "--channel"}});
    return;
  case SensorKind::analogue:
    options["sources.acs.units." + channel] = "--channel";
    return;
  }
}

Options options_of(const BenchDraft& draft) {
  Options options;
  add_excitation(draft, options);
  add_acs(draft, options);
  add_sensor(draft, options);
  return options;
}

bool is_of_a_key(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_';
}

// "duration_s" of "excitation.duration_s", as sentences about its table call it; a name without
// an underline may be any word.
std::string name_within_table(const std::string& key) {
  const std::string name = key.substr(key.rfind('.') + 1);
  return name.find('_') == std::string::npos ? key : name;
}

void name_options(const std::string& key, const std::string& option, std::string& sentence) {
  const std::string named = fmt::format("{} ({})", option, key);
  for (std::size_t at = sentence.find(key); at != std::string::npos;) {
    const std::size_t end = at + key.size();
    const bool whole = (at == 0 || !(is_of_a_key(sentence[at - 1]) || sentence[at - 1] == '.')) &&
                       (end == sentence.size() || !is_of_a_key(sentence[end]));
    if (whole) {
      sentence.replace(at, key.size(), named);
    }
    at = sentence.find(key, at + (whole ? named.size() : key.size()));
  }
}

// A file that has no such channel is refused by its own key.
void name_options_of_channels(const BenchDraft& draft, const std::string& key,
                              std::string& sentence) {
  Options options; // by channel
  if (key.starts_with("sources.acs.")) {
    options = {{draft.reference, "--reference"}, {draft.sync, "--sync"}};
  } else {
    options = {{draft.sensor_sync, "--sensor-sync"}};
  }
  if (!key.starts_with("sources.acs.") || draft.sensor == SensorKind::analogue) {
    options.emplace(channel_of(draft), "--channel");
  }
  for (const auto& [channel, option] : options) {
    const std::string missing = fmt::format("no channel '{}'", channel);
    if (const std::size_t at = sentence.find(missing); at != std::string::npos) {
      sentence.insert(at + missing.size(), fmt::format(" ({})", option));
    }
  }
}

} // namespace

std::optional<std::string> option_of(const BenchDraft& draft, const std::string& key) {
  const Options options = options_of(draft);
  const auto found = options.find(key);
  return found == options.end() ? std::nullopt : std::optional(found->second);
}

std::string sentence_with_options(const BenchDraft& draft, const std::string& key,
                                  std::string sentence) {
  for (const auto& [other, option] : options_of(draft)) {
    if (other.starts_with("excitation.") || other.starts_with("generator.")) {
      name_options(name_within_table(other), option, sentence);
    }
    if (other.find('.') != std::string::npos) {
      name_options(other, option, sentence);
    }
  }
  name_options_of_channels(draft, key, sentence);
  const auto option = option_of(draft, key);
  return option ? fmt::format("{} ({}) {}", *option, key, sentence)
                : fmt::format("key '{}' {}", key, sentence);
}

} // namespace dyncal::inline programs
