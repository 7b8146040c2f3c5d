// What a shell completes on the command line of a program: a script for bash, zsh or fish, from the
// description that --help has as well. Commands, options, the choices of an option, and files
// where a value or an argument may be one; arguments that are named *.toml complete such files.
// Any thread.
#pragma once

#include <string>

#include "services/base/error.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline daemon {

// Fails (bad_argument) with another shell than "bash", "zsh" and "fish".
[[nodiscard]] Expected<std::string> completion_script(const CLI::App& app,
                                                      const std::string& shell);

} // namespace dyncal::inline daemon
