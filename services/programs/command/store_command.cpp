#include "services/programs/command/store_command.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/contract/run_identity.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/work_progress.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

std::string addition_text(StoreAddition addition) {
  switch (addition) {
  case StoreAddition::added:
    return "added";
  case StoreAddition::already_there:
    return "already there";
  case StoreAddition::replaced_unfinished:
    return "in place of the result of the run before it had ended";
  }
  return "";
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
  fmt::print("{:<20} {:<16} {:<26} {:<12} {:>9}  {}\n", "begin (UTC)", "bench", "run", "state",
             "steps", "sources");
  for (const StoredRun& run : runs) {
    fmt::print("{:<20} {:<16} {:<26} {:<12} {:>9}  {}\n",
               run.began_utc.empty() ? "-" : one_line(run.began_utc.substr(0, 19)) + "Z",
               one_line(run.bench), one_line(RunIdentity::parse(run.run).name), one_line(run.state),
               fmt::format("{}/{}", run.measured_steps, run.planned_steps),
               one_line(sensors_text(run)));
  }
}

} // namespace

int run_store_add(const StoreAddCommand& command) {
  auto store = Store::open(store_place(command.store.store, command.store.folder));
  if (!store) {
    return report_error(store.error());
  }
  int status = 0;
  WorkProgress progress("adding");
  progress.count()->begin("adding", "results", command.results.size());
  for (const std::filesystem::path& result : command.results) {
    const auto added = (*store)->add(result);
    progress.count()->add_done();
    progress.clear();
    if (added) {
      fmt::print("{}: {}\n", result.string(), addition_text(*added));
    } else {
      status = report_error(added.error());
    }
  }
  return status;
}

int run_runs(const RunsCommand& command) {
  const auto runs = [&]() -> Expected<std::vector<StoredRun>> {
    const WorkProgress progress("opening the store");
    auto store = Store::open_existing(store_place(command.store.store, command.store.folder));
    return store ? (*store)->runs(command.filter, progress.count()) : fail(store.error());
  }();
  if (!runs) {
    return report_error(runs.error());
  }
  if (command.json) {
    Json json{{"runs", Json::array()}};
    for (const StoredRun& run : *runs) {
      json["runs"].push_back(run_json(run));
    }
    fmt::print("{}\n", json_text(json, 2));
    return 0;
  }
  if (runs->empty()) {
    return report_error({ErrorCode::no_result, "the store has no such run"});
  }
  print_table(*runs);
  return 0;
}

} // namespace dyncal::inline programs
