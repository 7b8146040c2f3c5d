// `dyncal combine RUN RUN...`: the runs of one sensor that was mounted anew for each of them as one
// result (services/views/report/combined_result.hpp), which goes into the store and may have a
// certificate of its own. Each run is held against its recording and the store before, as before a
// certificate. Belongs to one thread.
#include <chrono>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "services/base/output_file.hpp"
#include "services/contract/time_name.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/provenance/result_provenance.hpp"
#include "services/records/store/store.hpp"
#include "services/views/language/translated_texts.hpp"
#include "services/views/report/combined_result.hpp"
#include "services/views/report/result_json.hpp"

namespace dyncal::inline programs {
namespace {

struct CombineOptions {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path output;
  StorePlace store;
};

void add_combine(CLI::App& command, CombineOptions& options) {
  take_run(command.add_option("RUN", options.runs, "run folder or result file, one a mounting"))
      ->required()
      ->expected(2, CLI::detail::expected_max_vector_size);
  command.add_option("--output", options.output, "result file (JSON) to write")->required();
  add_store_place(command, options.store);
}

Expected<std::vector<StoredResult>> read_runs(const CombineOptions& options,
                                              const SharedWorkCount& count,
                                              const std::stop_token& stop) {
  std::vector<StoredResult> runs;
  for (const std::filesystem::path& run : options.runs) {
    DYNCAL_TRY(auto held, read_held_result(run, options.store.text_for(run), count, stop));
    if (!held.objections.empty()) {
      return fail(ErrorCode::no_result,
                  fmt::format("{}: {}", run.string(),
                              fmt::join(texts_in(Language::english, held.objections), "; ")));
    }
    runs.push_back(std::move(held.result));
  }
  return runs;
}

Expected<int> run_combine(const CombineOptions& options, const std::stop_token& stop) {
  DYNCAL_TRY(const auto runs,
             with_progress("holding the runs against their recordings",
                           [&](const auto& count) { return read_runs(options, count, stop); }));
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const std::string name =
      "combined-" + time_name(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
  DYNCAL_TRY(const auto combined, combined_result(runs, name));
  DYNCAL_TRY(check_new_file(options.output));
  DYNCAL_TRY(write_json(options.output, result_json(combined)));
  fmt::print("{}: {} values of {} mountings\n", options.output.string(), combined.values.size(),
             runs.size());
  const std::string place = options.store.text_for(options.runs.front());
  if (place.empty()) {
    return 0;
  }
  DYNCAL_TRY(auto store, Store::open(place));
  DYNCAL_TRY(const auto added, store->add(options.output));
  static_cast<void>(added);
  fmt::print("and in the store {}: dyncal certify {}\n", without_password(place),
             options.output.string());
  return 0;
}

const Command combine_command{
    184, "combine", "combine the runs of one sensor, mounted anew for each, into one result",
    add_combine, run_combine};

} // namespace
} // namespace dyncal::inline programs
