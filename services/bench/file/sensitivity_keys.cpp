#include "services/bench/file/sensitivity_keys.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/contract/channel_unit.hpp"
#include "services/contract/quantity.hpp"

namespace dyncal::inline bench {
namespace {

// The scale factor of its [channel] becomes that of the channel; a sentence where it cannot.
std::string take_channel_unit(const std::string& channel, const ReferenceFile& file,
                              SourceSettings& source) {
  if (file.channel_unit.empty()) {
    return "";
  }
  const auto unit = parse_channel_unit(file.channel_unit);
  if (!unit) {
    return fmt::format("names a file whose [channel] is {}, which {}", file.channel_unit,
                       unit.error().message);
  }
  const auto plain = source.units.find(channel);
  const bool is_voltage =
      plain == source.units.end() || quantity_of_unit(plain->second) == Quantity::voltage;
  if (!is_voltage || !source.identity.units.emplace(channel, *unit).second) {
    return fmt::format("names a file that divides channel '{}' by {}, but 'units' states another "
                       "unit of it: leave it out there",
                       channel, file.channel_unit);
  }
  return "";
}

// A sentence where the response of a channel cannot be taken from the results.
std::string assign(const ChannelName& channel, const ReferenceFile& sensitivity, BenchFile& file) {
  CorrectionSettings& corrections = file.corrections;
  if (channel == file.method.reference) {
    if (!corrections.reference.empty() || !corrections.reference_standard.devices.empty()) {
      return fmt::format("is given for {}, but corrections.reference names its response too: leave "
                         "one of them out",
                         channel.text());
    }
    corrections.reference = sensitivity.response;
    corrections.reference_standard = sensitivity.standard;
    corrections.reference_notes = sensitivity.notes;
    corrections.reference_phase_in_rad = sensitivity.phase_in_rad;
    return "";
  }
  if (std::ranges::find(file.method.dut, channel) == file.method.dut.end()) {
    return fmt::format("is given for {}, which is neither method.reference nor named in method.dut",
                       channel.text());
  }
  if (!sensitivity.response.empty()) {
    corrections.channel_responses.push_back({channel, sensitivity.response});
  }
  return "";
}

} // namespace

void read_sensitivities(TomlTable& table, NamedFiles& files, SourceSettings& source) {
  std::size_t entry = 0;
  for (const auto& [channel, name] : table.text_map("sensitivity")) {
    ++entry;
    auto file = read_reference_file(name, files);
    if (!file) {
      table.refuse_entry("sensitivity", entry, "names " + file.error().message);
      continue;
    }
    if (const std::string problem = take_channel_unit(channel, *file, source); !problem.empty()) {
      table.refuse_entry("sensitivity", entry, problem);
    }
    source.sensitivities.emplace(channel, std::move(*file));
  }
}

void assign_sensitivities(TomlTable sources, BenchFile& file) {
  for (const SourceSettings& source : file.sources) {
    auto table = source.sensitivities.empty() ? std::nullopt : sources.table(source.name);
    if (!table) {
      continue;
    }
    std::size_t entry = 0;
    for (const auto& [channel, sensitivity] : source.sensitivities) {
      ++entry;
      const std::string problem = assign({source.name, channel}, sensitivity, file);
      if (!problem.empty()) {
        table->refuse_entry("sensitivity", entry, problem);
      }
    }
  }
}

} // namespace dyncal::inline bench
