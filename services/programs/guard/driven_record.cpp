#include "services/programs/guard/driven_record.hpp"

#include <array>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"

namespace dyncal::inline programs {
namespace {

using nlohmann::json;

// A bench's name is any text; as the name of a file it is not.
std::string file_name(const std::string& bench) {
  std::string name;
  for (const char letter : bench) {
    const bool is_plain = (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
                          (letter >= 'A' && letter <= 'Z') || letter == '-';
    name += is_plain ? std::string(1, letter)
                     : fmt::format("_{:02x}", static_cast<unsigned char>(letter));
  }
  return name + ".json";
}

DrivenRun run_of(const json& kept) {
  DrivenRun run;
  run.run = kept.at("run").get<std::string>();
  run.has_ended = kept.at("has_ended").get<bool>();
  run.is_conducted = kept.value("is_conducted", false);
  for (const json& one : kept.at("settings")) {
    OutputSettings settings;
    settings.frequency_hz = one.at("frequency_hz").get<double>();
    if (one.contains("voltage_vpp")) {
      settings.voltage_vpp = one.at("voltage_vpp").get<double>();
    }
    if (run.settings.size() < ExciterWatch::max_settings) {
      run.settings.push_back(settings);
    }
  }
  return run;
}

constexpr std::array link_names{"measurement_link", "excitation_link"}; // by ChainTopic

Conductor conductor_of(const json& kept) {
  Conductor conductor{kept.at("run").get<std::string>(), kept.at("participant").get<std::string>()};
  for (std::size_t topic = 0; topic < link_names.size(); ++topic) {
    if (const auto shown = kept.find(link_names[topic]); shown != kept.end()) {
      const auto link = parse_chain_link(shown->at("link").get<std::string>());
      conductor.links[topic] = {shown->at("number").get<std::uint64_t>(),
                                link.value_or(ChainLink{})};
    }
  }
  return conductor;
}

void add_conductor(const Conductor& conductor, json& to) {
  to["participant"] = conductor.participant;
  for (std::size_t topic = 0; topic < link_names.size(); ++topic) {
    if (const auto& shown = conductor.links[topic]) {
      to[link_names[topic]] = {{"number", shown->number}, {"link", to_string(shown->link)}};
    }
  }
}

} // namespace

std::filesystem::path guard_state_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value != nullptr ? value : "");
  };
  if (auto folder = variable("STATE_DIRECTORY"); !folder.empty()) {
    return folder;
  }
  if (const auto folder = variable("XDG_STATE_HOME"); !folder.empty()) {
    return folder / "dyncal-guard";
  }
  const auto home = variable("HOME");
  return (home.empty() ? std::filesystem::temp_directory_path() : home / ".local" / "state") /
         "dyncal-guard";
}

DrivenRecord::DrivenRecord(const std::filesystem::path& folder, const std::string& bench,
                           std::string generator)
    : path_(folder / file_name(bench)), generator_(std::move(generator)) {}

DrivenRun DrivenRecord::read() const {
  std::ifstream in(path_);
  const json kept = json::parse(in, nullptr, false);
  try {
    return kept.is_object() && kept.at("generator") == generator_ ? run_of(kept) : DrivenRun{};
  } catch (const json::exception&) {
    return {};
  }
}

Conductor DrivenRecord::read_conductor() const {
  std::ifstream in(path_);
  const json kept = json::parse(in, nullptr, false);
  try {
    return kept.is_object() && kept.at("generator") == generator_ ? conductor_of(kept)
                                                                  : Conductor{};
  } catch (const json::exception&) {
    return {}; // damaged, or of a guard that kept none
  }
}

Expected<void> DrivenRecord::write(const DrivenRun& run, const Conductor& conductor) const {
  std::error_code failure;
  if (run.run.empty()) {
    std::filesystem::remove(path_, failure);
    return {};
  }
  std::filesystem::create_directories(path_.parent_path(), failure); // if not, writing says why
  json settings = json::array();
  for (const OutputSettings& one : run.settings) {
    json entry = {{"frequency_hz", one.frequency_hz}};
    if (one.voltage_vpp) {
      entry["voltage_vpp"] = *one.voltage_vpp;
    }
    settings.push_back(std::move(entry));
  }
  json kept{{"generator", generator_},
            {"run", run.run},
            {"has_ended", run.has_ended},
            {"is_conducted", run.is_conducted},
            {"settings", std::move(settings)}};
  if (conductor.run == run.run) {
    add_conductor(conductor, kept);
  }
  return write_output_file(path_, json_text(kept));
}

} // namespace dyncal::inline programs
