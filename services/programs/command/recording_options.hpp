// The commands about recordings and their options: `recording check|repair|info`, `replay`,
// `export`.
// Belongs to one thread.
#pragma once

#include <optional>

#include "services/programs/command/export_command.hpp"
#include "services/programs/command/recording_command.hpp"
#include "services/programs/command/replay_command.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline programs {

struct RecordingCommands {
  RecordingCommand recording;
  ReplayCommand replay;
  ExportCommand exported;
};

// The options are kept in `commands`, which must outlive the parsing.
void add_recordings(CLI::App& app, RecordingCommands& commands);

// The exit status of `recording`; nothing where the command line does not have it.
[[nodiscard]] std::optional<int> run_recording(const CLI::App& app,
                                               const RecordingCommands& commands);

} // namespace dyncal::inline programs
