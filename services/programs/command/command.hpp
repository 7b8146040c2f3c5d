// A command of `dyncal`, which registers itself. NAME_command.cpp holds its options, what it does
// with them, and at its end
//
//   const Command fit_command{240, "fit", "one sine approximation of a record", add_fit, run_fit};
//
// add_fit(CLI::App&, FitOptions&) describes the options, run_fit(FitOptions&) does what was asked
// for once the command line has been read. With a std::stop_token as second parameter it is told of
// Ctrl-C, otherwise that ends the program at once. It returns Expected<void>, or Expected<int>
// where it has an exit status of its own; an error is reported by main.cpp.
//
// The number is its place in --help, manual pages and completion; those of one subject stand
// together. "calibrate adc" is below `calibrate`, which has a smaller number and no functions.
// Belongs to the main thread; a Command is static.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <type_traits>

#include <CLI/CLI.hpp>

#include "services/base/error.hpp"
#include "services/daemon/program/options.hpp"
#include "services/daemon/program/program.hpp"

namespace dyncal::inline programs {

// Exit statuses beside those that errors have (daemon/program/program.hpp).
inline constexpr int problems_found = 3; // it could look, and what it looked at is wrong
inline constexpr int could_not_look = 4;

class Command {
public:
  using Action = std::function<Expected<int>()>; // the exit status, or what went wrong

  template <class Options, class Run>
  Command(int place, const char* name, const char* description,
          void (*add_options)(CLI::App&, Options&), Run* run)
      : Command(place, name, description, [add_options, run](CLI::App& command) -> Action {
          const auto options = std::make_shared<Options>();
          add_options(command, *options);
          return [options, run] {
            if constexpr (std::is_invocable_v<Run, Options&, const std::stop_token&>) {
              return status_of(run(*options, stop_on_signals()));
            } else {
              return status_of(run(*options));
            }
          };
        }) {}
  // One that has others below it. `add`: adds the options to what has been made of it.
  Command(int place, std::string name, std::string description,
          std::function<Action(CLI::App&)> add = {});

private:
  static Expected<int> status_of(Expected<int> status) { return status; }
  static Expected<int> status_of(const Expected<void>& done) {
    return done.map([] { return 0; });
  }
};

// Adds every command that has registered itself. `chosen`: what is to be done, once `app` has read
// the command line; both outlive that.
void add_commands(CLI::App& app, Command::Action& chosen);

} // namespace dyncal::inline programs
