#include "services/bench/file/driver_tables.hpp"

#include <cmath>
#include <optional>

#include <fmt/core.h>
#include <toml++/toml.h>

namespace dyncal::inline bench {

double read_play_speed(TomlTable& table) {
  const toml::node* play = table.node("play");
  if (play == nullptr) {
    return 0.0;
  }
  if (play->is_number()) {
    const double speed = table.number("play", 1.0, "");
    if (speed <= 0.0) {
      table.refuse("play", "must be positive: 10.0 plays ten times faster than real time");
    }
    return speed;
  }
  return table.one_of("play", {"at-once", "real-time"}, "at-once") == "real-time" ? 1.0 : 0.0;
}

std::map<std::string, double> read_scale(TomlTable& table) {
  std::map<std::string, double> scale = table.number_map("scale");
  std::size_t entry = 0;
  for (const auto& [channel, factor] : scale) {
    ++entry;
    if (factor == 0.0) {
      table.refuse_entry(
          "scale", entry,
          fmt::format("gives channel '{}' the factor 0: all its values would be 0", channel));
    }
  }
  return scale;
}

namespace {

constexpr double max_time_offset_s = 1e9; // more than 30 years

// The colon of "FILE:CHANNEL" follows the file's ending; those before it are of the file's name
// ("acs 10:20:30.csv").
std::size_t place_of_colon(const std::string& text) {
  std::size_t colon = text.find(':');
  while (colon != std::string::npos &&
         !std::filesystem::path(text.substr(0, colon)).has_extension()) {
    colon = text.find(':', colon + 1);
  }
  return colon;
}

// Without a channel its name is empty.
NamedChannel named_channel(const std::string& text, NamedFiles& files) {
  const std::size_t colon = place_of_colon(text);
  const std::string file = text.substr(0, colon);
  const std::string name = colon == std::string::npos ? "" : text.substr(colon + 1);
  std::filesystem::path data = file;
  if (file.ends_with(".sigmf-meta") || file.ends_with(".sigmf-data")) {
    // A recording is two files, and a run folder copies both.
    static_cast<void>(files.resolve(data.replace_extension(".sigmf-meta").string()));
    data.replace_extension(".sigmf-data");
  }
  return {files.resolve(data.string()), name};
}

std::string problem_with(const NamedChannel& channel) {
  return std::filesystem::is_regular_file(channel.path)
             ? ""
             : fmt::format("names {}, which does not exist or is not a file",
                           channel.path.string());
}

void read_path(TomlTable& table, NamedFiles& files, FileSourceSettings& file) {
  const toml::node* node = table.node("path");
  if (node == nullptr || !node->is_array()) {
    const std::string text = table.required_text("path");
    const NamedChannel only = named_channel(text, files);
    file.path = only.path;
    if (const std::string problem = problem_with(only); !text.empty() && !problem.empty()) {
      table.refuse("path", problem);
    }
    if (!only.name.empty()) {
      file.single.push_back(only);
    }
    return;
  }
  const std::vector<std::string> texts = table.texts("path");
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const NamedChannel channel = named_channel(texts[i], files);
    if (const std::string problem = problem_with(channel); !problem.empty()) {
      table.refuse_entry("path", i, problem);
    } else if (channel.name.empty()) {
      table.refuse_entry("path", i,
                         fmt::format("names the file {}, but no channel in it: a list is of "
                                     "channels, \"FILE:CHANNEL\"",
                                     texts[i]));
    }
    file.single.push_back(channel);
  }
  if (texts.empty()) {
    table.refuse("path", "must name a file, or channels in files");
    return;
  }
  file.path = file.single.front().path;
}

void read_adjustments(TomlTable& table, FileSourceSettings& file) {
  file.time_offset_s = table.number("time_offset_s", 0.0, "seconds");
  if (!(std::abs(file.time_offset_s) <= max_time_offset_s)) {
    table.refuse("time_offset_s", "must be from -1e9 to 1e9, in seconds");
  }
  file.scale = read_scale(table);
}

} // namespace

FileSourceSettings read_file_source(TomlTable& table, NamedFiles& files) {
  FileSourceSettings file;
  read_path(table, files, file);
  file.play_speed = read_play_speed(table);
  file.sample_rate_hz = table.optional_number("sample_rate_hz", "Hz");
  if (file.sample_rate_hz && *file.sample_rate_hz <= 0.0) {
    table.refuse("sample_rate_hz", "must be positive, in Hz");
  }
  file.group = table.text("group", "");
  file.u_stamp_s = table.number("u_stamp_s", 0.0, "seconds");
  if (!(file.u_stamp_s >= 0.0 && file.u_stamp_s <= 1.0)) {
    table.refuse("u_stamp_s", "must be from 0 to 1, in seconds");
  }
  read_adjustments(table, file);
  return file;
}

} // namespace dyncal::inline bench
