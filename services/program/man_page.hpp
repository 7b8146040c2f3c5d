// Manual pages (man(7), section 1) of a program and of each of its commands, from the description
// that its --help has as well. Any thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/error.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::services {

// Of the program, or of the command that these words name: {"calibrate", "adc"}. Fails
// (bad_argument) when there is no such command.
[[nodiscard]] Expected<std::string> man_page(const CLI::App& app,
                                             const std::vector<std::string>& command);

// PROGRAM.1, and PROGRAM-COMMAND.1 for every command, in this folder, which is made. Fails
// (bad_file).
[[nodiscard]] Expected<void> write_man_pages(const CLI::App& app,
                                             const std::filesystem::path& folder);

} // namespace dyncal::services
