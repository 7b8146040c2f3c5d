// `dyncal recording check|repair|info FILE`: whether a recording is sound, a whole one of one that
// is not, and what is in it. Belongs to the thread that owns standard output.
#pragma once

#include <filesystem>
#include <string>

namespace dyncal::inline programs {

struct RecordingCommand {
  std::filesystem::path file;
  std::filesystem::path repaired; // of repair; empty: FILE with ".repaired.mcap"
};

// Every damage with its place; exit status 0 only when there is none.
[[nodiscard]] int run_recording_check(const RecordingCommand& command);
[[nodiscard]] int run_recording_repair(const RecordingCommand& command);
[[nodiscard]] int run_recording_info(const RecordingCommand& command);

} // namespace dyncal::inline programs
