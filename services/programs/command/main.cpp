// The dyncal command-line tool; its commands register themselves (command.hpp).
#include <CLI/CLI.hpp>

#include "services/base/version.hpp"
#include "services/daemon/program/command_line.hpp"
#include "services/programs/command/command.hpp"

int main(int argc, char** argv) { // NOLINT(bugprone-exception-escape): ends the program
  using namespace dyncal;
  CLI::App app{"Dynamic calibration of mechanical sensors with digital output, carried by DDS.",
               "dyncal"};
  app.footer("Exit status: 0 success, 1 failure, 2 wrong command line, 3 problems found by check, "
             "compare, "
             "doctor or recording check, 130 interrupted.");
  app.set_version_flag("--version", build_description());
  app.require_subcommand(1);
  Command::Action chosen;
  add_commands(app, chosen);
  if (const auto status = read_command_line(app, argc, argv)) {
    return *status;
  }
  set_up_log("dyncal");
  const auto status = chosen();
  return status ? *status : report_error(status.error());
}
