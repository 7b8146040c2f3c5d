// [run] of a bench file: what is done when one of its runs has ended.
//
//   on_end = ["/usr/local/bin/tell", "lab@example.org"]   a program and its arguments; no shell
//   on_end_limit_s = 30.0                                 how long it may take
//
// Only who conducts a run from a file of this computer does it; so it is read from the text of the
// bench file when it is needed, never from a recipe that came over the bus. Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

struct RunEndSettings {
  std::vector<std::string> command; // not empty
  double limit_s = 30.0;
};

// Nothing: nothing is done. Adds what is wrong to the problems of the file.
[[nodiscard]] std::optional<RunEndSettings> read_run_end(TomlTable& root);

// Of the text of a bench file that is valid.
[[nodiscard]] std::optional<RunEndSettings> run_end_settings_of(const std::string& bench_text);

// A key that is a program and its arguments. Empty: it is not there.
[[nodiscard]] std::vector<std::string> read_local_command(TomlTable& table, const std::string& key);

} // namespace dyncal::inline bench
