#include "services/programs/command/keep_options.hpp"

#include <CLI/CLI.hpp>

#include "services/records/run_folder/run_folder.hpp"
#include "services/records/store/store.hpp"

namespace dyncal::inline programs {
namespace {

void add_store_option(CLI::App& command, std::string& store) {
  command
      .add_option("--store", store,
                  "file or postgresql://... that keeps all results, or none (default: "
                  "$DYNCAL_STORE, or dyncal.sqlite in the folder of all runs)")
      ->envname("DYNCAL_STORE");
}

} // namespace

void add_keep_options(CLI::App& command, KeepOptions& keep) {
  command
      .add_option("--folder", keep.folder,
                  "folder of all runs; this one goes to BENCH/RUN in it (default: $DYNCAL_RUNS, or "
                  "runs in the current folder)")
      ->envname("DYNCAL_RUNS");
  command.add_flag("--recording,!--no-recording", keep.recording,
                   "record everything that the bench's programs tell each other (default)");
  add_store_option(command, keep.store);
}

std::string StorePlace::text() const {
  return store_place(store, folder.value_or("runs"));
}

std::string StorePlace::text_for(const std::filesystem::path& run) const {
  std::error_code unknown;
  const auto root =
      std::filesystem::canonical(run, unknown).parent_path().parent_path(); // "" of what is not
  const bool is_beside = std::filesystem::is_directory(run, unknown) &&
                         std::filesystem::exists(root / "dyncal.sqlite", unknown);
  return store.empty() && !folder && is_beside ? store_place("", root) : text();
}

void add_store_place(CLI::App& command, StorePlace& place) {
  command
      .add_option("--folder", place.folder,
                  "folder of all runs (default: $DYNCAL_RUNS, or runs in the current folder)")
      ->envname("DYNCAL_RUNS");
  add_store_option(command, place.store);
}

void add_operator_option(CLI::App& command, std::string& name) {
  command.add_option("--operator", name,
                     "who does this, for records and documents (default: $DYNCAL_OPERATOR, or the "
                     "name of the login)");
}

CLI::Option* take_run(CLI::Option* option) {
  return option->transform([](const std::string& typed) { return run_path(typed).string(); });
}

std::filesystem::path file_beside_run(const std::filesystem::path& run, const std::string& name) {
  std::error_code unknown;
  return std::filesystem::is_directory(run, unknown)
             ? run / name
             : run.parent_path() / (run.stem().string() + "-" + name);
}

} // namespace dyncal::inline programs
