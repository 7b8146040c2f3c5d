// `dyncal runs`: the runs in the store of all results, or some of them. Belongs to one thread.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/contract/run_identity.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/store/store.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

struct RunsOptions {
  StorePlace store;
  RunFilter filter;
  bool json = false;
};

void add_runs(CLI::App& command, RunsOptions& runs) {
  command.add_option("--bench", runs.filter.bench, "only of this bench");
  command.add_option("--sensor", runs.filter.sensor,
                     "only with this sensor: serial number, device or source");
  command.add_option("--since", runs.filter.since,
                     "only begun at this time or later: 2026-11-22 or 2026-11-22T10:15, UTC");
  command.add_option("--until", runs.filter.until, "only begun at this time or earlier");
  command.add_option("--state", runs.filter.state, "only in this state")
      ->check(
          CLI::IsMember({"complete", "incomplete", "interrupted", "ended-early", "unfinished"}));
  command.add_flag("--json", runs.json, "print JSON");
  add_store_place(command, runs.store);
}

std::string sensors_text(const StoredRun& run) {
  std::string text;
  for (const RunSource& source : run.sources) {
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", source.source,
                        source.description.serial.empty() ? "" : " " + source.description.serial);
  }
  return text;
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json run_json(const StoredRun& run) {
  Json json{{"bench", run.bench},
            {"run", run.run},
            {"state", run.state},
            {"began_utc", text_or_null(run.began_utc)},
            {"ended_utc", text_or_null(run.ended_utc)},
            {"method", run.method},
            {"planned_steps", run.planned_steps},
            {"measured_steps", run.measured_steps},
            {"problem", run.problem},
            {"software", run.software},
            {"recipe_sha256", run.recipe_sha256},
            {"result_sha256", run.result_sha256},
            {"folder", run.folder},
            {"conducted_by", text_or_null(run.conducted_by)},
            {"amendments", run.amendments},
            {"sources", Json::array()}};
  for (const RunSource& source : run.sources) {
    json["sources"].push_back({{"source", source.source},
                               {"device", source.description.device},
                               {"serial", source.description.serial},
                               {"firmware", source.description.firmware}});
  }
  return json;
}

void print_table(const std::vector<StoredRun>& runs) {
  fmt::print("{:<20} {:<16} {:<26} {:<12} {:>9}  {:<16} {}\n", "begin (UTC)", "bench", "run",
             "state", "steps", "operator", "sources");
  for (const StoredRun& run : runs) {
    fmt::print("{:<20} {:<16} {:<26} {:<12} {:>9}  {:<16} {}\n",
               run.began_utc.empty() ? "-" : one_line(run.began_utc.substr(0, 19)) + "Z",
               one_line(run.bench), one_line(RunIdentity::parse(run.run).name), one_line(run.state),
               fmt::format("{}/{}", run.measured_steps, run.planned_steps),
               run.conducted_by.empty() ? "-" : one_line(run.conducted_by),
               one_line(sensors_text(run)));
  }
  for (const StoredRun& run : runs) {
    for (const std::string& sentence : run.amendments) {
      fmt::print("{}, {}: {}\n", one_line(run.bench), one_line(RunIdentity::parse(run.run).name),
                 one_line(sentence));
    }
  }
}

Expected<void> run_runs(const RunsOptions& command) {
  const auto runs = with_progress(
      "opening the store", [&](const SharedWorkCount& count) -> Expected<std::vector<StoredRun>> {
        DYNCAL_TRY(auto store, Store::open_existing(command.store.text()));
        return store->runs(command.filter, count);
      });
  DYNCAL_TRY(runs);
  if (command.json) {
    Json json{{"runs", Json::array()}};
    for (const StoredRun& run : *runs) {
      json["runs"].push_back(run_json(run));
    }
    fmt::print("{}\n", json_text(json, 2));
    return {};
  }
  if (runs->empty()) {
    return fail(ErrorCode::no_result, "the store has no such run");
  }
  print_table(*runs);
  return {};
}

const Command runs_command{90, "runs", "list the runs in the store, or find some", add_runs,
                           run_runs};

} // namespace
} // namespace dyncal::inline programs
