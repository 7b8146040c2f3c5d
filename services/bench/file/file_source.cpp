#include "services/bench/file/driver_tables.hpp"

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

FileSourceSettings read_file_source(TomlTable& table, NamedFiles& files) {
  FileSourceSettings file;
  const std::string path = table.required_text("path");
  file.path = files.resolve(path);
  if (!path.empty() && !std::filesystem::is_regular_file(file.path)) {
    table.refuse(
        "path", fmt::format("names {}, which does not exist or is not a file", file.path.string()));
  }
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
  return file;
}

} // namespace dyncal::inline bench
