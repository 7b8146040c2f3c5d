// How grave something is, and what a check has to say about one thing: of a bench file, of the
// network, of what the bus shows. The words are the same for a program, a page and a check.
//
// Plain data and functions; any thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace dyncal::inline base {

// The worse the higher. Stale: nothing is known, for nothing is heard any more.
enum class Severity { ok, note, warning, error, stale };

[[nodiscard]] constexpr const char* to_string(Severity severity) {
  switch (severity) {
  case Severity::ok:
    break;
  case Severity::note:
    return "note";
  case Severity::warning:
    return "warning";
  case Severity::error:
    return "error";
  case Severity::stale:
    return "stale";
  }
  return "ok";
}

struct Finding {
  Severity severity = Severity::ok;
  std::string subject;  // what was looked at: "multicast"; the key of a file, "excitation.level"
  std::string sentence; // what there is, and what to do about it
  std::string file{};   // where the subject is a key, or the file as a whole (empty subject)
  std::size_t line = 0; // of the file; 0: it cannot be read
};

using Findings = std::vector<Finding>;

inline void append(Findings& findings, const Findings& more) {
  findings.insert(findings.end(), more.begin(), more.end());
}

// Ok without findings.
[[nodiscard]] inline Severity worst(const Findings& findings) {
  const auto found = std::ranges::max_element(findings, {}, &Finding::severity);
  return found == findings.end() ? Severity::ok : found->severity;
}

} // namespace dyncal::inline base
