#include "services/programs/command/calibrate_options.hpp"

#include <CLI/CLI.hpp>

namespace dyncal::inline programs {
namespace {

void add_dso_delay(CLI::App& calibrate, CalibrateDsoDelayCommand& delay) {
  CLI::App* command =
      calibrate.add_subcommand("dso-delay", "delay of an oscilloscope's trigger output");
  command->add_option("--oscilloscope", delay.oscilloscope, "HOST:PORT, or vxi11:HOST")->required();
  command->add_option("--family", delay.family,
                      "command family of the oscilloscope (default: by its identity)");
  command->add_option("--generator", delay.generator, "HOST:PORT (default: set by hand)");
  command
      ->add_option("--by", delay.by,
                   "sync signal: rectangle (from edge to edge) or sine (from the trigger point; "
                   "its noise is reported)")
      ->check(CLI::IsMember({"rectangle", "sine"}))
      ->capture_default_str();
  command->add_option("--frequency", delay.frequency_hz, "frequency of the generator in Hz")
      ->capture_default_str();
  command
      ->add_option("--amplitude", delay.amplitude_v,
                   "amplitude of the generator in V, zero to peak")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--sync-input", delay.sync_input,
                   "input of the oscilloscope that sync is connected to; it triggers")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command
      ->add_option("--output-input", delay.output_input,
                   "input of the oscilloscope that its trigger output is connected to")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command->add_option("--sync-range", delay.sync_range_v, "range of that input in V peak to peak")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--output-range", delay.output_range_v, "range of that input in V peak to peak")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--shots", delay.shots, "shots to take")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  command->add_option("--output", delay.output, "file for the result as JSON")
      ->capture_default_str();
}

void add_time(CLI::App& calibrate, CalibrateTimeCommand& time) {
  CLI::App* command = calibrate.add_subcommand(
      "time", "deviation of a DAU's time stamps from a reference pulse per second");
  command
      ->add_option(
          "FILE", time.files,
          "records of pulse edges, lines of GPST;n;ticks and REFT;n;ticks; several are one record")
      ->required();
  command->add_option("--reference-offset", time.reference_offset_s,
                      "seconds by which the reference pulse comes after the second of GPS, if that "
                      "is known: gives the mean a meaning");
  command
      ->add_option("--reference-uncertainty", time.u_reference_s,
                   "standard uncertainty of the reference pulse, in seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--output", time.output,
                   "file for the result as JSON; a figure (SVG and CSV) comes beside it")
      ->capture_default_str();
}

void add_adc(CLI::App& calibrate, CalibrateAdcCommand& adc) {
  CLI::App* command =
      calibrate.add_subcommand("adc", "response of a DAU's sync ADC over frequency and amplitude, "
                                      "against the ACS; both must stamp in UTC");
  command
      ->add_option("BENCH.toml", adc.bench_file,
                   "bench file: its frequencies and repetitions are measured")
      ->required();
  command
      ->add_option("--amplitudes", adc.amplitudes_vpp,
                   "of sync, in V peak to peak, comma separated; the generator's output must be "
                   "sync (default: the bench's levels, one amplitude)")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command->add_option("--channel", adc.channel, "name of the ADC in the file")
      ->capture_default_str();
  command
      ->add_option("--time-uncertainty", adc.u_time_scale_s,
                   "standard uncertainty of the stamps of DAU and ACS against each other, in "
                   "seconds (see calibrate time)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--gain-uncertainty", adc.u_acs_gain_rel,
                   "relative standard uncertainty of the ACS's sync channel")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--output", adc.output, "file that [corrections] adc of a bench file names")
      ->capture_default_str();
  add_network_options(*command, adc.network);
}

} // namespace

void add_calibrate(CLI::App& app, CalibrateCommands& commands) {
  CLI::App* calibrate = app.add_subcommand("calibrate", "calibrate an instrument of the bench");
  calibrate->require_subcommand(1);
  add_adc(*calibrate, commands.adc);
  add_dso_delay(*calibrate, commands.dso_delay);
  add_time(*calibrate, commands.time);
}

int run_calibrate(const CLI::App& app, const CalibrateCommands& commands,
                  const std::stop_token& stop) {
  const CLI::App* calibrate = app.get_subcommand("calibrate");
  if (calibrate->got_subcommand("adc")) {
    return run_calibrate_adc(commands.adc, stop);
  }
  if (calibrate->got_subcommand("dso-delay")) {
    return run_calibrate_dso_delay(commands.dso_delay, stop);
  }
  return run_calibrate_time(commands.time);
}

} // namespace dyncal::inline programs
