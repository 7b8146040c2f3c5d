// `dyncal store add RESULT...`: puts results into the store of all results
// (services/records/store). It goes on after one that is refused; the exit status then is that of
// the last. `dyncal store audit`: its audit trail, and whether anything was changed behind its
// back. Belongs to one thread.
#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/store/store.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

struct StoreAddOptions {
  StorePlace store;
  std::vector<std::filesystem::path> results; // files and run folders
};

void add_store_add(CLI::App& command, StoreAddOptions& add) {
  take_run(
      command.add_option("RESULT", add.results, "result file (JSON) or run folder, repeatable"))
      ->required();
  add_store_place(command, add.store);
}

const char* addition_text(StoreAddition addition) {
  return addition == StoreAddition::added           ? "added"
         : addition == StoreAddition::already_there ? "already there"
                                                    : "in place of the result of the run before it "
                                                      "had ended";
}

Expected<int> run_store_add(const StoreAddOptions& command) {
  DYNCAL_TRY(auto store, Store::open(command.store.text()));
  int status = 0;
  WorkProgress progress("adding");
  progress.count()->begin("adding", "results", command.results.size());
  for (const std::filesystem::path& result : command.results) {
    const auto added = store->add(result);
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

struct StoreAuditOptions {
  StorePlace store;
  std::string head; // SHA-256 of an entry that was noted; empty: none
  bool json = false;
};

void add_store_audit(CLI::App& command, StoreAuditOptions& audit) {
  command.add_option("--head", audit.head,
                     "SHA-256 that an earlier audit ended with: the trail must still have it");
  command.add_flag("--json", audit.json, "print JSON");
  add_store_place(command, audit.store);
}

Json audit_json(const std::vector<AuditEntry>& entries, const std::vector<std::string>& problems) {
  Json json{{"entries", Json::array()}, {"problems", problems}};
  for (const AuditEntry& entry : entries) {
    json["entries"].push_back({{"number", entry.number},
                               {"at_utc", entry.at_utc},
                               {"name", entry.by.name},
                               {"user", entry.by.user},
                               {"host", entry.by.host},
                               {"action", entry.action},
                               {"subject", entry.subject},
                               {"detail", entry.detail},
                               {"previous_sha256", entry.previous_sha256},
                               {"sha256", entry.sha256}});
  }
  return json;
}

void print_audit(const std::vector<AuditEntry>& entries, const std::vector<std::string>& problems) {
  for (const AuditEntry& entry : entries) {
    fmt::print("{:>5}  {}  {:<15}  {}: {}\n", entry.number, one_line(entry.at_utc),
               one_line(entry.action), one_line(text_of(entry.by)), one_line(entry.detail));
  }
  for (const std::string& problem : problems) {
    fmt::print("PROBLEM: {}\n", one_line(problem));
  }
  fmt::print("{} entries, {}\n", entries.size(),
             problems.empty() ? "the chain is whole and the store agrees with it"
                              : fmt::format("{} problems", problems.size()));
  if (!entries.empty()) {
    fmt::print("head {}\n", entries.back().sha256);
  }
}

Expected<int> run_store_audit(const StoreAuditOptions& command) {
  DYNCAL_TRY(auto store, Store::open_existing(command.store.text()));
  DYNCAL_TRY(const auto entries, store->audit());
  DYNCAL_TRY(auto problems, store->audit_problems());
  if (!command.head.empty() &&
      std::ranges::find(entries, command.head, &AuditEntry::sha256) == entries.end()) {
    problems.push_back("the head that was noted is not in the trail: entries are gone, or the "
                       "store is another");
  }
  if (command.json) {
    fmt::print("{}\n", json_text(audit_json(entries, problems), 2));
  } else {
    print_audit(entries, problems);
  }
  return problems.empty() ? 0 : problems_found;
}

const Command store_command{80, "store", "the store of all results"};
const Command store_add_command{81, "store add", "add results to the store (idempotent)",
                                add_store_add, run_store_add};
const Command store_audit_command{82, "store audit",
                                  "list who did what to the store, and check that nothing was "
                                  "changed behind its back",
                                  add_store_audit, run_store_audit};

} // namespace
} // namespace dyncal::inline programs
