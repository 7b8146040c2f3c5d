// Looks into findings. For tests.
#pragma once

#include <algorithm>

#include "services/base/finding.hpp"

namespace dyncal::tests {

// Sentences of one severity, each with its check before it: "twins: two services ...".
inline std::vector<std::string> sentences(const Findings& findings, Severity severity) {
  std::vector<std::string> texts;
  for (const auto& finding : findings) {
    if (finding.severity == severity) {
      texts.push_back(finding.subject + ": " + finding.sentence);
    }
  }
  return texts;
}

inline std::vector<std::string> problems(const Findings& findings) {
  return sentences(findings, Severity::error);
}

inline std::vector<std::string> warnings(const Findings& findings) {
  return sentences(findings, Severity::warning);
}

} // namespace dyncal::tests
