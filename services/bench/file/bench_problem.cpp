#include "services/bench/file/bench_problem.hpp"

#include <fmt/core.h>

namespace dyncal::inline bench {

std::string BenchProblem::text(std::string_view severity) const {
  const std::string place = line == whole_file ? file : fmt::format("{}:{}", file, line);
  const std::string about = key.empty() ? std::string() : fmt::format("key '{}' ", key);
  const std::string weight = severity.empty() ? std::string() : fmt::format("{}: ", severity);
  return fmt::format("{}: {}{}{}", place, weight, about, sentence);
}

} // namespace dyncal::inline bench
