// What a shell completes on the command line of a program: commands, options, the choices of an
// option, and files where a value or an argument may be one; an argument that is named *.toml
// completes such files. The script of each shell asks the program itself, which knows all of it
// from the description that --help has as well. Any thread.
#pragma once

#include <string>
#include <vector>

#include "services/base/error.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
class Option;
} // namespace CLI

namespace dyncal::inline daemon {

// What people see of a program or command: all that is not hidden.
[[nodiscard]] std::vector<const CLI::App*> shown_commands(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> shown_options(const CLI::App& app);

// Calls `PROGRAM --complete WORDS...`. Fails (bad_argument) with another shell than "bash", "zsh"
// and "fish".
[[nodiscard]] Expected<std::string> completion_script(const CLI::App& app,
                                                      const std::string& shell);

// What fits behind the words of a command line without its program, in place of the last one, which
// is being typed: a line each, "--domain<tab>DDS domain", or a pattern of files,
// "/*.toml<tab>files". Not only what begins with the last word: shells differ in what they let fit.
[[nodiscard]] std::string completion_offers(const CLI::App& app, std::vector<std::string> words);

} // namespace dyncal::inline daemon
