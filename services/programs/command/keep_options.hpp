// Options of the command line for what is kept of runs: the run folder, the store, and the commands
// that look into it.
#pragma once

#include "services/programs/command/history_command.hpp"
#include "services/programs/command/run_command.hpp"
#include "services/programs/command/store_command.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
class Option;
} // namespace CLI

namespace dyncal::inline programs {

// --folder, --store
void add_keep_options(CLI::App& command, KeepOptions& keep);

// The option names a run: its folder, or ROOT/BENCH/NAME for the newest of that name.
void take_run(CLI::Option& option);

struct StoreCommands {
  StoreAddCommand add;
  RunsCommand runs;
  HistoryCommand history;
};

// The commands `store`, `runs` and `history`.
void add_store(CLI::App& app, StoreCommands& commands);

// Nothing when the command line has none of them.
[[nodiscard]] std::optional<int> run_store(const CLI::App& app, const StoreCommands& commands);

} // namespace dyncal::inline programs
