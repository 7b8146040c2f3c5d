// The command line of every program: read by CLI11, with one line for what is wrong with it.
//
// A program describes its commands and options once, in a CLI::App. That description serves the
// parser, --help, from which the manual pages are made, and the shells (completion.hpp). For the
// last two every program has options that --help does not list, each as the first argument:
// `--print-commands` (each with what it is for), `--print-completion bash|zsh|fish`, and
// `--complete`, which the scripts of the shells call.
//
// What is wrong is one sentence that names the command or option and, when it is unknown, the one
// that was probably meant; the exit status is 2. Belongs to the main thread.
#pragma once

#include <optional>

#include "services/base/error.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline daemon {

// Of a wrong command line.
inline constexpr int wrong_command_line = 2;

// True: go on; false: all that was asked for has been printed. Fails (bad_argument) with what is
// wrong.
[[nodiscard]] Expected<bool> parse_command_line(CLI::App& app, int argc, const char* const* argv);

// The same for main functions: what is wrong is printed as "PROGRAM: sentence". The exit status,
// unless the program is to go on.
[[nodiscard]] std::optional<int> read_command_line(CLI::App& app, int argc,
                                                   const char* const* argv);

} // namespace dyncal::inline daemon
