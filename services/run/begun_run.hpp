// A run that is resumed, as its folder knows it, and whether what goes on with it is the same:
// results by two recipes would stand side by side. Whether the instruments are the same is seen
// when they describe themselves (run_messages.hpp). Plain data, any thread.
#pragma once

#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline run {

struct BegunRun {
  std::string recipe_sha256;
  std::vector<RunSource> sources; // as they described themselves
  bool has_results = false;
};

[[nodiscard]] Error other_bench_file(const std::string& run_name);
// Fails (bad_file) also where the bench file is the same, and a file that it names has changed.
[[nodiscard]] Expected<void> check_same_recipe(const BegunRun& begun, const std::string& run_name,
                                               const std::string& recipe_sha256);

} // namespace dyncal::inline run
