// `dyncal check BENCH.toml...`: all that is wrong with bench files, and with them together
// (services/checks/bench_check); nothing is driven, and no network is used. The exit status is 0
// without errors, 1 with some. Belongs to one thread.
#pragma once

#include <filesystem>
#include <vector>

namespace dyncal::inline programs {

struct CheckCommand {
  std::vector<std::filesystem::path> bench_files;
  bool json = false;
  bool asks_generator = false; // who it is; nothing else is asked or driven
};

[[nodiscard]] int run_check(const CheckCommand& command);

} // namespace dyncal::inline programs
