// One thing that the doctor has to say. Plain data.
#pragma once

#include <string>
#include <vector>

namespace dyncal::inline checks::doctor {

enum class Severity { ok, warning, problem };

[[nodiscard]] inline const char* to_string(Severity severity) {
  return severity == Severity::ok ? "ok" : severity == Severity::warning ? "warning" : "problem";
}

struct Finding {
  Severity severity = Severity::ok;
  std::string check;    // what was looked at, one word or two, for programs: "multicast"
  std::string sentence; // what there is, and what to do about it
};

using Findings = std::vector<Finding>;

} // namespace dyncal::inline checks::doctor
