#include "drivers/files/file_channels.hpp"

#include <algorithm>
#include <utility>

namespace dyncal::drivers::files {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text.empty() ? "none" : text;
}

// "acceleration_x [\metre]" as `dyncal export` writes it: name and unit.
std::pair<std::string, std::string> name_and_unit(const std::string& text) {
  const std::size_t bracket = text.find(" [");
  if (bracket == std::string::npos || bracket == 0 || !text.ends_with(']')) {
    return {text, ""};
  }
  return {text.substr(0, bracket), text.substr(bracket + 2, text.size() - bracket - 3)};
}

tl::unexpected<Error> unknown(const FileSettings& settings, const char* what,
                              const std::string& name, const std::vector<std::string>& known) {
  return fail(ErrorCode::not_found, settings.path.string() + ": no " + what + " '" + name +
                                        "'; the file has: " + listed(known));
}

} // namespace

Expected<SourceDescription> describe_file_channels(const FileSettings& settings,
                                                   const std::vector<std::string>& texts) {
  std::vector<std::string> names;
  std::vector<std::string> units;
  for (const std::string& text : texts) {
    auto [name, unit] = name_and_unit(text);
    names.push_back(std::move(name));
    units.push_back(std::move(unit));
  }
  for (const auto& [file_name, name] : settings.channels) {
    if (std::find(names.begin(), names.end(), file_name) == names.end()) {
      return unknown(settings, "channel", file_name, names);
    }
  }
  SourceDescription description;
  description.device = "file " + settings.path.filename().string();
  description.driver = "file";
  description.time_base = settings.time_base;
  description.nominal_rate_hz = settings.sample_rate ? settings.sample_rate->hz() : 0.0;
  std::vector<std::string> ours;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    const auto renamed = settings.channels.find(name);
    ChannelDescription channel;
    channel.name = renamed == settings.channels.end() ? name : renamed->second;
    if (std::find(ours.begin(), ours.end(), channel.name) != ours.end()) {
      return fail(ErrorCode::invalid_setting,
                  settings.path.string() + ": two channels are called '" + channel.name + "'");
    }
    ours.push_back(channel.name);
    const auto unit = settings.units.find(channel.name);
    channel.unit = unit == settings.units.end() ? units[i] : unit->second;
    if (channel.unit != units[i]) {
      channel.quantity = units[i]; // what the file says itself can still be held against a role
    }
    description.channels.push_back(channel);
  }
  for (const auto& [name, unit] : settings.units) {
    if (std::find(ours.begin(), ours.end(), name) == ours.end()) {
      return unknown(settings, "channel", name, ours);
    }
  }
  return description;
}

} // namespace dyncal::drivers::files
