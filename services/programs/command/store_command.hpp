// `dyncal store add`, `dyncal runs` and `dyncal history`: the store of all results, from the
// command line. Each returns the exit status. Belong to one thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/records/store/store.hpp"

namespace dyncal::inline programs {

// Where the store is.
struct StoreOptions {
  std::filesystem::path folder = "runs"; // of all runs
  std::string store;                     // as store_place() takes it
};

struct StoreAddCommand {
  StoreOptions store;
  std::vector<std::filesystem::path> results; // files and run folders
};

// Goes on after one that is refused; the exit status then is not 0.
[[nodiscard]] int run_store_add(const StoreAddCommand& command);

struct RunsCommand {
  StoreOptions store;
  RunFilter filter;
  bool json = false;
};

[[nodiscard]] int run_runs(const RunsCommand& command);

} // namespace dyncal::inline programs
