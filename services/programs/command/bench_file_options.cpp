#include "services/programs/command/bench_file_options.hpp"

#include <CLI/CLI.hpp>

namespace dyncal::inline programs {
namespace {

void add_check(CLI::App& app, CheckCommand& check) {
  CLI::App* command =
      app.add_subcommand("check", "validate bench files and the files they reference (dry run)");
  command
      ->add_option("BENCH.toml", check.bench_files,
                   "bench files; several are also held against each other")
      ->required();
  command->add_flag("--json", check.json, "print JSON");
  command->add_flag("--ask-generator", check.asks_generator,
                    "ask the generator who it is: another program's settings are read back only "
                    "where its family is known");
  command->footer(
      "Exit status: 0 no errors (there may be warnings), 1 errors, 2 wrong command line.");
}

void add_kinds(CLI::App& command, NewBenchCommand& bench) {
  command
      .add_option("--sensor", bench.sensor,
                  "smartup (of a SmartUp Unit), file (a record of it), can, series (triggered by "
                  "an oscilloscope) or analogue (a channel of the analogue system)")
      ->check(CLI::IsMember(bench_draft::sensor_kinds()))
      ->capture_default_str();
  command
      .add_option("--acs", bench.acs, "analogue system with the reference: its stream, or a file")
      ->check(CLI::IsMember(bench_draft::acs_kinds()))
      ->capture_default_str();
  command.add_option("--generator", bench.generator, "what excites the bench")
      ->check(CLI::IsMember(bench_draft::generator_kinds()))
      ->capture_default_str();
}

void add_places(CLI::App& command, bench_draft::BenchDraft& draft) {
  command.add_option("--listen", draft.listen, "address and UDP port that the unit sends to")
      ->capture_default_str();
  command.add_option("--sensor-id", draft.sensor_id, "id of the sensor in the unit")
      ->capture_default_str();
  command.add_option("--sensor-file", draft.sensor_file, "the sensor's record");
  command.add_option("--sensor-address", draft.sensor_address, "of a time series sensor")
      ->capture_default_str();
  command.add_option("--dso-address", draft.dso_address, "of the oscilloscope that triggers it")
      ->capture_default_str();
  command.add_option("--interface", draft.interface, "of a sensor on CAN")->capture_default_str();
  command.add_option("--dbc", draft.dbc, "its DBC file (default: one to adapt is written)");
  command.add_option("--channel", draft.sensor_channel,
                     "of the sensor (default: acceleration_z; sensor of an analogue one)");
  command.add_option("--sensor-sync", draft.sensor_sync, "channel of sync in the sensor's record")
      ->capture_default_str();
  command.add_option("--acs-address", draft.acs_address, "of the analogue system")
      ->capture_default_str();
  command.add_option("--acs-file", draft.acs_file, "the reference's record");
  command.add_option("--reference", draft.reference, "its channel in the analogue system")
      ->capture_default_str();
  command.add_option("--sync", draft.sync, "channel of sync in the analogue system")
      ->capture_default_str();
  command.add_option("--generator-address", draft.generator_address, "of the generator")
      ->capture_default_str();
}

void add_excitation(CLI::App& command, bench_draft::BenchDraft& draft) {
  command.add_option("--frequencies", draft.frequencies_hz, "in Hz, decimal text, comma separated")
      ->delimiter(',')
      ->capture_default_str();
  command.add_option("--level", draft.level_m_s2, "in m/s^2, amplitude")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--repetitions", draft.repetitions, "of the whole list")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--duration", draft.duration_s, "evaluated seconds of every step")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--level-per-volt", draft.level_per_volt, "m/s^2 at the exciter for 1 V")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      .add_option("--maximum-voltage", draft.maximum_voltage_v, "of the generator, amplitude in V")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

void add_new_bench(CLI::App& app, NewBenchCommand& bench) {
  CLI::App* command = app.add_subcommand(
      "new-bench", "write a bench file to start from, by these options or by questions");
  command->add_option("--name", bench.draft.name,
                      "name of the bench (default: all is asked for on the terminal)");
  command->add_option("--output", bench.output, "file to write (default: NAME.toml)");
  add_kinds(*command, bench);
  add_places(*command, bench.draft);
  add_excitation(*command, bench.draft);
}

} // namespace

void add_bench_files(CLI::App& app, BenchFileCommands& commands) {
  add_check(app, commands.check);
  add_new_bench(app, commands.new_bench);
}

std::optional<int> run_bench_file_command(const CLI::App& app, const BenchFileCommands& commands) {
  if (app.got_subcommand("check")) {
    return run_check(commands.check);
  }
  if (app.got_subcommand("new-bench")) {
    return run_new_bench(commands.new_bench);
  }
  return std::nullopt;
}

} // namespace dyncal::inline programs
