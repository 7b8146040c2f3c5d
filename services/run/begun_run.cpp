#include "services/run/begun_run.hpp"

#include <fmt/core.h>

namespace dyncal::inline run {

Error other_bench_file(const std::string& run_name) {
  return {ErrorCode::bad_file, fmt::format("run '{}' was made with another bench file; resume it "
                                           "with that one, or begin a new run",
                                           run_name)};
}

Expected<void> check_same_recipe(const BegunRun& begun, const std::string& run_name,
                                 const std::string& recipe_sha256) {
  if (begun.recipe_sha256 == recipe_sha256) {
    return {};
  }
  Error other = other_bench_file(run_name);
  other.message += fmt::format(" (SHA-256 of its recipe {:.12}, of this one {:.12})",
                               begun.recipe_sha256, recipe_sha256);
  return fail(std::move(other));
}

} // namespace dyncal::inline run
