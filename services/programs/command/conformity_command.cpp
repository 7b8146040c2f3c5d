// `dyncal conformity RUN`: does a stored run meet its tolerances (services/views/conformity)?
//
// Tolerances stand in a file of their own (--tolerances) or in the sensor file (--sensor). Prints a
// table, or JSON; --keep writes conformity.json into the run folder, where the page shows it. Exit
// status 0: everything passes; 3: not so, or undecided; 1 and one line when something is wrong.
// Belongs to one thread.
#include <fmt/core.h>

#include "services/base/json_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/judged_run.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/named_sensor.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/conformity/conformity_json.hpp"
#include "services/views/conformity/conformity_table.hpp"

namespace dyncal::inline programs {
namespace {

struct ConformityOptions {
  std::filesystem::path run;
  std::filesystem::path tolerances;
  SensorOptions sensor;
  StorePlace store;
  std::vector<std::string> channels;
  bool keep = false;
  bool json = false;
};

void add_conformity_options(CLI::App& command, ConformityOptions& options) {
  take_run(command.add_option("RUN", options.run, "run folder, or a result file (JSON)"))
      ->required();
  CLI::Option* tolerances = command.add_option("--tolerances", options.tolerances,
                                               "tolerance file: [conformity] and [[tolerance]]");
  add_sensor_option(command, options.sensor.sensor)->excludes(tolerances);
  command.add_option("--channel", options.channels,
                     "channel to judge (repeatable; default: all that respond)");
  command.add_flag("--keep", options.keep,
                   "write conformity.json into the run folder too, where the page shows it");
  command.add_flag("--json", options.json, "print JSON");
  add_store_place(command, options.store);
  command.footer("Exit status: 0 everything passes, 1 failure, 2 wrong command line, 3 something "
                 "does not pass or is undecided.");
}

Expected<JudgedRun> judge(const ConformityOptions& options) {
  DYNCAL_TRY(auto result, read_values(options.run));
  std::optional<Tolerances> of_sensor;
  if (options.tolerances.empty()) {
    DYNCAL_TRY(const auto sensor,
               sensor_of_run(options.sensor, result, options.store.text_for(options.run)));
    of_sensor = sensor ? sensor->tolerances : std::nullopt;
  }
  return judge_run(std::move(result), options.channels, options.tolerances, of_sensor);
}

Expected<int> run_conformity(const ConformityOptions& options) {
  DYNCAL_TRY(const auto judged,
             with_progress("reading the run", [&](const auto&) { return judge(options); }));
  if (options.keep) {
    DYNCAL_TRY(const auto file, keep_conformity(options.run, judged));
    fmt::print(stderr, "wrote {}\n", file.string());
  }
  fmt::print("{}", options.json ? json_text(conformity_json(judged.report, judged.result), 2) + "\n"
                                : conformity_table(judged.report));
  return judged.report.statement() == analysis::ConformityStatement::pass ? 0 : problems_found;
}

const Command conformity_command{
    185, "conformity",
    "does a stored run meet its tolerances? pass, fail or undecided, with the "
    "probability of conformity",
    add_conformity_options, run_conformity};

} // namespace
} // namespace dyncal::inline programs
