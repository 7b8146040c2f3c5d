#include "services/programs/command/recording_options.hpp"

#include <CLI/CLI.hpp>

#include "services/programs/command/keep_options.hpp"

namespace dyncal::inline programs {
namespace {

void add_recording(CLI::App& app, RecordingCommand& recording) {
  CLI::App* command =
      app.add_subcommand("recording", "check, repair or describe a recording (.mcap)");
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* what) {
    CLI::App* verb = command->add_subcommand(name, what);
    verb->add_option("FILE", recording.file, "recording")->required();
    return verb;
  };
  add("check", "read all of it, and name every place that is damaged");
  add("repair", "write what is sound of it into a new file with an index")
      ->add_option("--output", recording.repaired, "the new file (default: FILE.repaired.mcap)");
  add("info", "what is in it");
}

void add_replay(CLI::App& app, ReplayCommand& replay) {
  CLI::App* command =
      app.add_subcommand("replay", "put a recording back on DDS, marked as a replay");
  command->add_option("RECORDING", replay.wish.recording, "recording (.mcap)")->required();
  command->add_option("--speed", replay.speed, "multiple of real time, or max")
      ->capture_default_str();
  command->add_option("--bench", replay.wish.bench,
                      "name of the bench on DDS (default: as it was recorded)");
  command->add_flag("--without-results", replay.without_results,
                    "leave out results and states of the analysis: a running analysis service "
                    "evaluates the run again");
  add_network_options(*command, replay.network);
}

void add_export(CLI::App& app, ExportCommand& exported) {
  CLI::App* command = app.add_subcommand(
      "export", "a recording for other programs: HDF5, NumPy, CSV, or MCAP with one message a "
                "sample");
  take_run(
      *command->add_option("SOURCE", exported.recording, "folder of a run, or recording (.mcap)")
           ->required());
  command
      ->add_option("--to", exported.to, "file to write, a folder for csv; nothing is overwritten")
      ->required();
  command->add_option("--format", exported.format,
                      "hdf5, npz, csv or mcap-rows (for "
                      "PlotJuggler, Foxglove, Lichtblick); default: by the name (.h5, .npz, .mcap, "
                      "else csv)");
  command->add_option("--channel", exported.channels,
                      "only this one, SOURCE/CHANNEL or SOURCE (repeatable; not for hdf5)");
}

} // namespace

void add_recordings(CLI::App& app, RecordingCommands& commands) {
  add_recording(app, commands.recording);
  add_replay(app, commands.replay);
  add_export(app, commands.exported);
}

std::optional<int> run_recording(const CLI::App& app, const RecordingCommands& commands) {
  const CLI::App* command = app.get_subcommand("recording");
  if (!command->parsed()) {
    return std::nullopt;
  }
  if (command->got_subcommand("repair")) {
    return run_recording_repair(commands.recording);
  }
  return command->got_subcommand("info") ? run_recording_info(commands.recording)
                                         : run_recording_check(commands.recording);
}

} // namespace dyncal::inline programs
