// The dyncal command-line tool.
#include <array>
#include <string>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "services/base/version.hpp"
#include "services/daemon/program/command_line.hpp"
#include "services/programs/command/analyse_command.hpp"
#include "services/programs/command/bench_file_options.hpp"
#include "services/programs/command/calibrate_options.hpp"
#include "services/programs/command/compare_command.hpp"
#include "services/programs/command/demo_command.hpp"
#include "services/programs/command/document_options.hpp"
#include "services/programs/command/figure_options.hpp"
#include "services/programs/command/fit_command.hpp"
#include "services/programs/command/intervals_command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/laboratory_options.hpp"
#include "services/programs/command/model_command.hpp"
#include "services/programs/command/recording_options.hpp"
#include "services/programs/command/run_command.hpp"
#include "services/programs/command/triaxial_command.hpp"
#include "services/run/output_guard.hpp"

namespace {

using namespace dyncal;

void add_run(CLI::App& app, RunCommand& run) {
  CLI::App* command =
      app.add_subcommand("run", "run the excitation list of a bench and print the result");
  command->add_option("BENCH.toml", run.bench_file, "bench file")->required();
  command->add_option("--run", run.run, "name of the run (default: the time)");
  auto* wait = command->add_flag("--wait", run.wait, "wait while another run has the bench");
  command->add_option("--resume", run.resume, "resume the named run after its conductor died")
      ->excludes("--run")
      ->excludes(wait);
  command->add_option("--json", run.json, "write the result to this file as JSON");
  add_figure_options(*command, run.figures);
  run.keep.folder = "runs";
  add_keep_options(*command, run.keep);
  add_network_options(*command, run.network);
}

void add_demo(CLI::App& app, DemoCommand& demo) {
  CLI::App* command = app.add_subcommand(
      "demo", "run a whole virtual bench with DDS, analysis and report on this machine");
  command
      ->add_option("--preset", demo.preset,
                   "mpu9250-paper, mpu9250-ptb, bma280, tss, can or can-sync")
      ->capture_default_str();
  command->add_option("--dds", demo.dds,
                      "fastdds, cyclonedds, or one for each: "
                      "dau=cyclonedds,acs=fastdds,analysis=cyclonedds,run=fastdds");
  command->add_flag("--trigger-correction,!--no-trigger-correction", demo.trigger_phase_correction,
                    "preset tss: correct every shot for the phase of sync at the trigger "
                    "(default); without it you see what the correction is worth");
  command->add_option("--speed", demo.speed, "multiple of real time, or max")
      ->capture_default_str();
  command->add_option("--seed", demo.seed, "seed of the virtual bench's random numbers")
      ->capture_default_str();
  command
      ->add_option("--domain", demo.domain, "DDS domain (default: one that other demos do not use)")
      ->envname("DYNCAL_DOMAIN")
      ->check(CLI::Range(0, 232));
  command->add_option("--output", demo.folder, "folder of all files")->capture_default_str();
  command->add_option("--json", demo.json,
                      "write the result to this file as JSON (default: result.json in the folder)");
  command->add_option("--folder", demo.keep.folder,
                      "keep the run below this folder as 'dyncal run' does (default: not)");
  command->add_option("--store", demo.keep.store, "store for that run, as in 'dyncal run'");
  command->add_option("--repetitions", demo.repetitions, "repetitions of the excitation list")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--duration", demo.duration_s,
                   "duration of the evaluated part of a step, in seconds of the bench")
      ->check(CLI::PositiveNumber);
  command->add_option("--loss", demo.loss, "fraction of the unit's datagrams that are lost, 0 to 1")
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--duplicate", demo.duplicates,
                   "fraction of the unit's datagrams that arrive twice, 0 to 1")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--response", demo.response,
                      "put a sensor with this response on the bench: CSV file, "
                      "frequency_hz,magnitude,phase_rad");
  command->add_option("--fault", demo.faults,
                      "what is wrong on purpose, again for each fault, as "
                      "'dyncal-virtual-bench --help' lists it: hum=0.01,at=sensor");
  command
      ->add_option("--can", demo.can_interface,
                   "interface for presets can and can-sync; 'ip link add vcan0 type vcan' makes a "
                   "virtual one")
      ->capture_default_str();
  command
      ->add_option("--can-bus", demo.can_bus,
                   "500k, 1M (classic CAN) or fd-5M (CAN FD, 1 and 5 Mbit/s)")
      ->check(CLI::IsMember({"500k", "1M", "fd-5M"}))
      ->capture_default_str();
}

void add_analyse(CLI::App& app, AnalyseCommand& analyse) {
  CLI::App* command = app.add_subcommand(
      "analyse", "evaluate the file sources of a bench file, or a recording, without the network");
  take_run(
      *command
           ->add_option("BENCH.toml", analyse.bench_file,
                        "bench file, the folder of a run, or a recording (.mcap), which gives the "
                        "results of the live run")
           ->required());
  command->add_option("--run", analyse.run, "run of the recording (default: the only one)");
  command->add_option("--recipe", analyse.recipe,
                      "evaluate the recording by this bench file, not by the one of its run");
  command->add_option("--json", analyse.json, "write the result to this file as JSON");
  add_figure_options(*command, analyse.figures);
}

void add_fit(CLI::App& app, FitCommand& fit) {
  CLI::App* command =
      app.add_subcommand("fit", "one sine approximation of a recorded series, for checking");
  command
      ->add_option("DATA.csv", fit.file,
                   "CSV with a header line, or .npy: column t_ns, further columns")
      ->required();
  command->add_option("--frequency", fit.frequency,
                      "in Hz (default: estimated as fourth parameter)");
  command->add_option("--column", fit.columns, "column to fit (repeatable; default: all)");
  command->add_option("--reference-time", fit.reference_time_ns,
                      "instant at which the phase is given, in ns (default: the first stamp)");
  command->add_option("--drift", fit.drift, "highest power of a drift beside the sine")
      ->check(CLI::Range(0, 8));
  command->add_option("--harmonics", fit.harmonics, "highest harmonic beside the sine")
      ->check(CLI::Range(1, 50));
  command->add_option("--hum", fit.hum, "frequency of a further line in Hz (repeatable)");
  command
      ->add_option("--nominal-rate", fit.nominal_rate_hz,
                   "replace the file's stamps by those of this rate in Hz")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", fit.json, "print JSON");
}

void add_intervals(CLI::App& app, IntervalsCommand& intervals) {
  CLI::App* command = app.add_subcommand(
      "intervals", "sample intervals of a recorded series: statistics and events");
  command->add_option("DATA.csv", intervals.file, "CSV with a header line, or .npy: column t_ns")
      ->required();
  command->add_option("--temperature", intervals.temperature,
                      "column with the sensor's temperature");
  command
      ->add_option("--tick", intervals.tick_s,
                   "tick of the counter that made the stamps, in seconds")
      ->check(CLI::PositiveNumber);
  command->add_option("--nominal-rate", intervals.nominal_rate_hz, "nominal sample rate in Hz")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", intervals.json, "print JSON");
}

void add_compare(CLI::App& app, CompareCommand& compare) {
  CLI::App* command = app.add_subcommand(
      "compare", "compare two results: E_n of magnitude and phase at every common frequency");
  command->add_option("A.json", compare.first, "result of dyncal")->required();
  command->add_option("B.json", compare.second, "the other result")->required();
  command->add_option("--channel", compare.first_channel, "only this channel (default: all)");
  command->add_option("--other-channel", compare.second_channel,
                      "its name in the other result (default: the same)");
  command
      ->add_option("--common-magnitude", compare.common_magnitude_rel,
                   "relative standard uncertainty that both results share, e.g. of one reference")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--common-phase", compare.common_phase_rad,
                   "standard uncertainty of the phase that both results share, in rad")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--json", compare.json, "print JSON");
}

void add_model_filter(CLI::App& command, ModelCommand& model) {
  command
      .add_option("--filter", model.filter,
                  "design a filter that undoes the response, with a low pass: fir or iir")
      ->check(CLI::IsMember({"fir", "iir"}));
  command
      .add_option("--rate-hz", model.rate_hz,
                  "sample rate of the filter (default: the sensor's, as measured)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--cutoff-hz", model.cutoff_hz,
                  "end of the filter's pass band (default: the highest fitted frequency)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--taps", model.taps,
                  "coefficients b of the filter (default: by the width of the transition)")
      ->check(CLI::Range(2, 513));
  command
      .add_option("--delay-samples", model.delay_samples,
                  "by how many samples the filter's output may be late (default: that with the "
                  "smallest error)")
      ->check(CLI::NonNegativeNumber);
}

void add_model(CLI::App& app, ModelCommand& model) {
  CLI::App* command = app.add_subcommand(
      "model", "fit gain, delay, first and second order to results; a filter that undoes the "
               "response");
  command
      ->add_option("RESULT.json", model.results,
                   "result of dyncal run or analyse; several are joined")
      ->required();
  command->add_option("--channel", model.channels,
                      "channel to fit (repeatable; default: all that respond)");
  command->add_option("--kind", model.kind, "the model (default: what the values support)")
      ->check(CLI::IsMember(model_kind_names()))
      ->capture_default_str();
  command->add_flag("--include-flagged", model.include_flagged,
                    "also fit values whose flags say that they may be wrong beyond u");
  command->add_option("--json", model.json,
                      "write models, covariances and filters to this file as JSON");
  command->add_option("--figures", model.figures,
                      "write figures of the residuals (SVG and CSV) into this folder");
  add_model_filter(*command, model);
}

void add_triaxial(CLI::App& app, TriaxialCommand& triaxial) {
  CLI::App* command = app.add_subcommand(
      "triaxial",
      "response of a sensor's three axes and transverse sensitivity, from one result for "
      "each direction of excitation");
  constexpr std::array axes{"x", "y", "z"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    command->add_option(std::string("--") + axes[i], triaxial.results[i],
                        std::string("result of the excitation along ") + axes[i]);
    command->add_option(
        std::string("--motion-") + axes[i], triaxial.motions[i],
        std::string("result of a triaxial reference's other axes against its axis ") + axes[i]);
  }
  command
      ->add_option(
          "--channels", triaxial.channels,
          "channels of the sensor: x, y, z (default: those whose names end with _x, _y, _z)")
      ->expected(3);
  command
      ->add_option(
          "--motion-channels", triaxial.motion_channels,
          "channels of the reference: x, y, z (default: those whose names end with _x, _y, _z)")
      ->expected(3);
  command
      ->add_option("--transverse-motion", triaxial.transverse_motion_rel,
                   "bound of the exciter's transverse motion, relative to that along its axis")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--json", triaxial.json, "print JSON");
}

// Not for people: services/run/output_guard.hpp starts it.
void add_guard_output(CLI::App& app, std::string& generator) {
  CLI::App* command = app.add_subcommand(
      "guard-output", "switch a generator's output off when standard input ends");
  command->group("");
  command->add_option("ADDRESS", generator, "of the generator, HOST:PORT")->required();
}

struct Commands {
  AnalyseCommand analyse;
  BenchFileCommands bench_files;
  CalibrateCommands calibrate;
  CompareCommand compare;
  TriaxialCommand triaxial;
  DemoCommand demo;
  DocumentCommands documents;
  FitCommand fit;
  std::string guarded_generator;
  IntervalsCommand intervals;
  ModelCommand model;
  RecordingCommands recordings;
  RunCommand run;
  StoreCommands store;
  LaboratoryCommands laboratory;
};

int execute(const CLI::App& app, const Commands& commands) {
  if (app.got_subcommand("compare")) {
    return run_compare(commands.compare);
  }
  if (app.got_subcommand("triaxial")) {
    return run_triaxial(commands.triaxial);
  }
  if (app.got_subcommand("model")) {
    return run_model(commands.model);
  }
  if (has_document_command(app)) {
    return run_document_command(app, commands.documents);
  }
  if (const auto status = run_bench_file_command(app, commands.bench_files)) {
    return *status;
  }
  if (app.got_subcommand("fit")) {
    return run_fit(commands.fit);
  }
  if (app.got_subcommand("intervals")) {
    return run_intervals(commands.intervals);
  }
  if (app.got_subcommand("guard-output")) {
    return guard_output(commands.guarded_generator, STDIN_FILENO);
  }
  if (const auto status = run_store(app, commands.store)) {
    return *status;
  }
  if (const auto status = run_recording(app, commands.recordings)) {
    return *status;
  }
  const std::stop_token stop = stop_on_signals();
  if (app.got_subcommand("replay")) {
    return run_replay(commands.recordings.replay, stop);
  }
  if (app.got_subcommand("export")) {
    return run_export(commands.recordings.exported, stop);
  }
  if (app.got_subcommand("calibrate")) {
    return run_calibrate(app, commands.calibrate, stop);
  }
  if (app.got_subcommand("analyse")) {
    return run_analyse(commands.analyse, stop);
  }
  if (app.got_subcommand("demo")) {
    return run_demo(commands.demo, stop);
  }
  if (const auto status = run_laboratory_command(app, commands.laboratory, stop)) {
    return *status;
  }
  const auto outcome = conduct_run(commands.run, stop);
  return outcome ? conclude(*outcome) : report_error(outcome.error());
}

} // namespace

int main(int argc, char** argv) { // NOLINT(bugprone-exception-escape): ends the program
  CLI::App app{"Dynamic calibration of mechanical sensors with digital output, carried by DDS.",
               "dyncal"};
  app.footer("Exit status: 0 success, 1 failure, 2 wrong command line, 130 interrupted.");
  app.set_version_flag("--version", build_description());
  app.require_subcommand(1);
  Commands commands;
  add_demo(app, commands.demo);
  add_run(app, commands.run);
  add_bench_files(app, commands.bench_files);
  add_laboratory(app, commands.laboratory);
  add_store(app, commands.store);
  add_analyse(app, commands.analyse);
  add_recordings(app, commands.recordings);
  add_compare(app, commands.compare);
  add_model(app, commands.model);
  add_triaxial(app, commands.triaxial);
  add_documents(app, commands.documents);
  add_fit(app, commands.fit);
  add_intervals(app, commands.intervals);
  add_calibrate(app, commands.calibrate);
  add_guard_output(app, commands.guarded_generator);
  if (const auto status = read_command_line(app, argc, argv)) {
    return *status;
  }
  set_up_log("dyncal");
  return execute(app, commands);
}
