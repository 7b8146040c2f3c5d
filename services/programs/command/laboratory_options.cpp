#include "services/programs/command/laboratory_options.hpp"

#include <CLI/CLI.hpp>

namespace dyncal::inline programs {
namespace {

void add_watch(CLI::App& app, WatchCommand& watch) {
  CLI::App* command = app.add_subcommand(
      "watch", "show benches, sources, losses, runs and results as they come, as a table that fits "
               "the terminal");
  command->add_option("--bench", watch.bench, "only this bench (default: all)");
  command->add_option("--seconds", watch.seconds, "end after this time (default: until Ctrl-C)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--all", watch.all,
                    "also runs that are over, channels that do not respond, benches that are gone, "
                    "and the clock of every host");
  command->add_flag("--flags", watch.flags,
                    "in the table every flag of a channel, and below what each of them means");
  command->add_flag("--json", watch.json, "print every change as a line of JSON");
  add_network_options(*command, watch.network);
}

void add_list(CLI::App& app, ListCommand& list) {
  CLI::App* command =
      app.add_subcommand("list", "list the benches, sources and runs that are on the network now");
  command->add_option("--bench", list.bench, "only this bench (default: all)");
  command->add_option("--seconds", list.seconds, "listen for this time at the most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--json", list.json, "print JSON");
  add_network_options(*command, list.network);
}

void add_doctor(CLI::App& app, DoctorCommand& doctor) {
  CLI::App* command =
      app.add_subcommand("doctor", "diagnose the laboratory, the network and this host");
  command->add_option("BENCH.toml", doctor.bench_file,
                      "bench file that the services should have read");
  command->add_option("--seconds", doctor.seconds, "look for this time")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--json", doctor.json, "print JSON");
  command->footer(
      "Exit status: 0 nothing is wrong, 1 warnings, 2 problems or a wrong command line, "
      "3 the bench file or the network cannot be used.");
  add_network_options(*command, doctor.network);
}

} // namespace

void add_laboratory(CLI::App& app, LaboratoryCommands& commands) {
  add_watch(app, commands.watch);
  add_list(app, commands.list);
  add_doctor(app, commands.doctor);
}

std::optional<int> run_laboratory_command(const CLI::App& app, const LaboratoryCommands& commands,
                                          const std::stop_token& stop) {
  if (app.got_subcommand("doctor")) {
    return run_doctor(commands.doctor, stop);
  }
  if (app.got_subcommand("list")) {
    return run_list(commands.list, stop);
  }
  if (app.got_subcommand("watch")) {
    return run_watch(commands.watch, stop);
  }
  return std::nullopt;
}

} // namespace dyncal::inline programs
