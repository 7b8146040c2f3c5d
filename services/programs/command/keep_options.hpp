// Options of commands about runs that are kept: where runs and their store are, and which run is
// meant. What is passed must live until the command line has been read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
class Option;
} // namespace CLI

namespace dyncal::inline programs {

struct KeepOptions {
  std::optional<std::filesystem::path> folder; // of all runs; nothing: no run folder
  bool recording = true;
  std::string store; // as store_place() takes it
};

// --folder, --recording, --store
void add_keep_options(CLI::App& command, KeepOptions& keep);

// --folder, --store of commands that only look at the store.
struct StorePlace {
  std::optional<std::filesystem::path> folder; // of all runs; nothing: runs
  std::string store;                           // as store_place() takes it

  [[nodiscard]] std::string text() const;
  // The one that was named, else that beside the folder of the run, if it is in there.
  [[nodiscard]] std::string text_for(const std::filesystem::path& run) const;
};
void add_store_place(CLI::App& command, StorePlace& place);

// --operator: who does it, a name for records and documents.
void add_operator_option(CLI::App& command, std::string& name);

// The option names a run: its folder, or ROOT/BENCH/NAME for the newest of that name. Returns it.
CLI::Option* take_run(CLI::Option* option);

// What is made of a run: NAME in its folder, RESULT-NAME beside RESULT.json.
[[nodiscard]] std::filesystem::path file_beside_run(const std::filesystem::path& run,
                                                    const std::string& name);

} // namespace dyncal::inline programs
