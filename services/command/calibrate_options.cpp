#include "services/command/calibrate_options.hpp"

#include <CLI/CLI.hpp>

namespace dyncal::services {
namespace {

void add_time(CLI::App& calibrate, CalibrateTimeCommand& time) {
  CLI::App* command = calibrate.add_subcommand("time", "deviation of a DAU's time stamps from a reference pulse per second");
  command->add_option("FILE", time.files, "records of pulse edges, lines of GPST;n;ticks and REFT;n;ticks; several are one record")
      ->required();
  command->add_option("--reference-offset", time.reference_offset_s,
                      "seconds by which the reference pulse comes after the second of GPS, if that is known: gives the mean a meaning");
  command->add_option("--reference-uncertainty", time.u_reference_s, "standard uncertainty of the reference pulse, in seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--output", time.output, "file for the result as JSON; a figure (SVG and CSV) comes beside it")
      ->capture_default_str();
}

} // namespace

void add_calibrate(CLI::App& app, CalibrateCommands& commands) {
  CLI::App* calibrate = app.add_subcommand("calibrate", "calibrate an instrument of the bench");
  calibrate->require_subcommand(1);
  add_time(*calibrate, commands.time);
}

int run_calibrate(const CLI::App&, const CalibrateCommands& commands) {
  return run_calibrate_time(commands.time);
}

} // namespace dyncal::services
