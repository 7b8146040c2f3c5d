#include "services/programs/command/keep_options.hpp"

#include <CLI/CLI.hpp>

#include "services/records/run_folder/run_folder.hpp"

namespace dyncal::inline programs {
namespace {

constexpr const char* folder_help =
    "folder of all runs (default: $DYNCAL_RUNS, or runs in the current folder)";
constexpr const char* store_help =
    "file or postgresql://... that keeps all results, or none (default: $DYNCAL_STORE, or "
    "dyncal.sqlite in the folder of all runs)";

void add_store_place(CLI::App& command, StoreOptions& store) {
  command.add_option("--folder", store.folder, folder_help)->envname("DYNCAL_RUNS");
  command.add_option("--store", store.store, store_help)->envname("DYNCAL_STORE");
}

void add_runs(CLI::App& app, RunsCommand& runs) {
  CLI::App* command = app.add_subcommand("runs", "list the runs in the store, or find some");
  command->add_option("--bench", runs.filter.bench, "only of this bench");
  command->add_option("--sensor", runs.filter.sensor,
                      "only with this sensor: serial number, device or source");
  command->add_option("--since", runs.filter.since,
                      "only begun at this time or later: 2026-11-22 or 2026-11-22T10:15, UTC");
  command->add_option("--until", runs.filter.until, "only begun at this time or earlier");
  command->add_option("--state", runs.filter.state, "only in this state")
      ->check(
          CLI::IsMember({"complete", "incomplete", "interrupted", "ended-early", "unfinished"}));
  command->add_flag("--json", runs.json, "print JSON");
  add_store_place(*command, runs.store);
}

void add_history(CLI::App& app, HistoryCommand& history) {
  CLI::App* command = app.add_subcommand(
      "history", "drift of a sensor over its calibrations, with U and E_n against the one before");
  command
      ->add_option("SENSOR", history.sensor, "serial number, device or source, as 'runs' lists it")
      ->required();
  command->add_option("--channel", history.channel, "only this channel (default: all)");
  command->add_option("--frequency", history.frequency_hz, "only this frequency in Hz")
      ->check(CLI::PositiveNumber);
  command->add_option("--figures", history.figures, "write figures (SVG and CSV) into this folder");
  command->add_flag("--json", history.json, "print JSON");
  add_store_place(*command, history.store);
}

} // namespace

void take_run(CLI::Option& option) {
  option.transform([](const std::string& typed) { return run_path(typed).string(); });
}

void add_keep_options(CLI::App& command, KeepOptions& keep) {
  command
      .add_option("--folder", keep.folder,
                  "folder of all runs; this one goes to BENCH/RUN in it (default: $DYNCAL_RUNS, or "
                  "runs in the current folder)")
      ->envname("DYNCAL_RUNS");
  command.add_flag("--recording,!--no-recording", keep.recording,
                   "record everything that the bench's programs tell each other (default)");
  command.add_option("--store", keep.store, store_help)->envname("DYNCAL_STORE");
}

void add_store(CLI::App& app, StoreCommands& commands) {
  CLI::App* store = app.add_subcommand("store", "the store of all results");
  store->require_subcommand(1);
  CLI::App* add = store->add_subcommand("add", "add results to the store (idempotent)");
  take_run(*add->add_option("RESULT", commands.add.results,
                            "result file (JSON) or run folder, repeatable")
                ->required());
  add_store_place(*add, commands.add.store);
  add_runs(app, commands.runs);
  add_history(app, commands.history);
}

std::optional<int> run_store(const CLI::App& app, const StoreCommands& commands) {
  if (app.got_subcommand("store")) {
    return run_store_add(commands.add);
  }
  if (app.got_subcommand("runs")) {
    return run_runs(commands.runs);
  }
  if (app.got_subcommand("history")) {
    return run_history(commands.history);
  }
  return std::nullopt;
}

} // namespace dyncal::inline programs
