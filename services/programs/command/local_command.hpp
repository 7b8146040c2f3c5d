// A program that a file of this laboratory names, with its arguments: started directly, without a
// shell, so that no text is taken for a command. It is found in PATH, has a time limit, and reads
// what the environment says beside this program's own.
//
// Fails (bad_file) where it cannot be started, ends with another status than 0, or is not ready in
// time, when it is ended; with its last line on standard error. Blocks; any thread.
#pragma once

#include <chrono>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline programs {

struct LocalCommand {
  std::vector<std::string> words; // program and arguments; not empty
  std::map<std::string, std::string> environment{};
  std::chrono::nanoseconds limit{};
};

// The beginning of what it printed.
[[nodiscard]] Expected<std::string> run_local_command(const LocalCommand& command,
                                                      const std::stop_token& stop = {});

} // namespace dyncal::inline programs
