// The commands for bench files, with their options and help: check and new-bench. Belongs to the
// main thread.
#pragma once

#include <optional>

#include "services/programs/command/check_command.hpp"
#include "services/programs/command/new_bench_command.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline programs {

struct BenchFileCommands {
  CheckCommand check;
  NewBenchCommand new_bench;
};

void add_bench_files(CLI::App& app, BenchFileCommands& commands);

// The exit status of the one that was chosen; nothing when none was.
[[nodiscard]] std::optional<int> run_bench_file_command(const CLI::App& app,
                                                        const BenchFileCommands& commands);

} // namespace dyncal::inline programs
