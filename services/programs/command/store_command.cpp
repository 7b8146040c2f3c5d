// `dyncal store add RESULT...`: puts results into the store of all results
// (services/records/store). It goes on after one that is refused; the exit status then is that of
// the last. Belongs to one thread.
#include <fmt/core.h>

#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/store/store.hpp"

namespace dyncal::inline programs {
namespace {

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

const Command store_command{80, "store", "the store of all results"};
const Command store_add_command{81, "store add", "add results to the store (idempotent)",
                                add_store_add, run_store_add};

} // namespace
} // namespace dyncal::inline programs
