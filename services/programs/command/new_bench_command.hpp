// `dyncal new-bench`: writes a bench file to start from (services/bench/draft), by options, or by
// questions on a terminal when no name is given. It never overwrites a file, and writes nothing
// that `dyncal check` would refuse. Belongs to one thread.
#pragma once

#include <filesystem>
#include <string>

#include "services/bench/draft/bench_draft.hpp"

namespace dyncal::inline programs {

struct NewBenchCommand {
  bench_draft::BenchDraft draft; // without a name: it is asked for
  std::string sensor = "smartup";
  std::string acs = "socket";
  std::string generator = "scpi";
  std::filesystem::path output; // empty: NAME.toml
};

[[nodiscard]] int run_new_bench(const NewBenchCommand& command);

} // namespace dyncal::inline programs
