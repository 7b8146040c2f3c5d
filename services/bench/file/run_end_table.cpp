#include "services/bench/file/run_end_table.hpp"

#include <toml++/toml.h>

#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline bench {

std::vector<std::string> read_local_command(TomlTable& table, const std::string& key) {
  if (!table.has(key)) {
    return {};
  }
  std::vector<std::string> command = table.texts(key);
  if (!table.refused(key) && (command.empty() || command.front().empty())) {
    table.refuse(key, "must be a program and its arguments: [\"program\", \"argument\"]");
  } else if (!command.empty() && command.front().find('=') != std::string::npos) {
    table.refuse(key, "names a program with '=' in its name");
  }
  return command;
}

std::optional<RunEndSettings> read_run_end(TomlTable& root) {
  constexpr double max_limit_s = 3600.0;
  auto table = root.table("run");
  if (!table) {
    return std::nullopt;
  }
  RunEndSettings settings;
  settings.command = read_local_command(*table, "on_end");
  if (!table->has("on_end")) {
    table->refuse("on_end", "is missing: the program that is started when a run has ended");
  }
  settings.limit_s = table->number("on_end_limit_s", settings.limit_s, "s");
  if (!(settings.limit_s > 0.0 && settings.limit_s <= max_limit_s)) {
    table->refuse("on_end_limit_s", "must be above 0 and at most 3600 s");
  }
  table->finish();
  return settings;
}

std::optional<RunEndSettings> run_end_settings_of(const std::string& bench_text) {
  const auto parsed = parse_toml(bench_text, "bench.toml");
  if (!parsed) {
    return std::nullopt;
  }
  BenchProblems problems;
  TomlTable root(*parsed, "", "bench.toml", problems);
  return read_run_end(root);
}

} // namespace dyncal::inline bench
