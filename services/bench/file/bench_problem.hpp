// One thing that is wrong in a bench file: where, and what to do about it. Plain data.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline bench {

struct BenchProblem {
  static constexpr std::size_t whole_file = 0; // as `line`: the file cannot be read

  std::string file;
  std::size_t line = 1;
  std::string key;      // "excitation.level"; empty: the file as a whole
  std::string sentence; // whose subject is the key: "must be positive, in m/s^2"

  // "bench.toml:7: key 'excitation.level' must be positive, in m/s^2"; with a severity
  // "bench.toml:7: error: key ...".
  [[nodiscard]] std::string text(std::string_view severity = {}) const;
};

using BenchProblems = std::vector<BenchProblem>;

} // namespace dyncal::inline bench
