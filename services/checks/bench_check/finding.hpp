// One thing that the check of a bench file has to say. Plain data.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyncal::inline checks::bench_check {

enum class Severity { note, warning, error };

[[nodiscard]] inline const char* to_string(Severity severity) {
  return severity == Severity::note ? "note" : severity == Severity::warning ? "warning" : "error";
}

struct Finding {
  Severity severity = Severity::note;
  std::string file;     // of the bench
  std::size_t line = 1; // 0: the file cannot be read
  std::string key;      // "excitation.level"; empty: the file as a whole
  std::string sentence; // after the key: what is so, and what to do
};

using Findings = std::vector<Finding>;

} // namespace dyncal::inline checks::bench_check
