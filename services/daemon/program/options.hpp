// Options of a command line as most of them are: checked, with their default in the help. What is
// passed must live until the command line has been read. Any thread.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace dyncal::inline daemon {

// An option that takes only what `check` passes.
template <class T>
CLI::Option* add_checked(CLI::App& command, const std::string& name, T& value,
                         const std::string& help, const CLI::Validator& check) {
  return command.add_option(name, value, help)->check(check);
}
// The same, where the help has the value before the command line is read, and any may pass.
template <class T>
CLI::Option* add_default(CLI::App& command, const std::string& name, T& value,
                         const std::string& help, const CLI::Validator& check = {}) {
  return add_checked(command, name, value, help, check)->capture_default_str();
}

} // namespace dyncal::inline daemon
