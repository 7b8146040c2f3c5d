// Looks into findings. For tests.
#pragma once

#include <algorithm>

#include "services/checks/doctor/finding.hpp"

namespace dyncal::tests {

using dyncal::doctor::Findings;
using dyncal::doctor::Severity;

// Sentences of one severity, each with its check before it: "twins: two services ...".
inline std::vector<std::string> sentences(const Findings& findings, Severity severity) {
  std::vector<std::string> texts;
  for (const auto& finding : findings) {
    if (finding.severity == severity) {
      texts.push_back(finding.check + ": " + finding.sentence);
    }
  }
  return texts;
}

inline std::vector<std::string> problems(const Findings& findings) {
  return sentences(findings, Severity::problem);
}

inline std::vector<std::string> warnings(const Findings& findings) {
  return sentences(findings, Severity::warning);
}

} // namespace dyncal::tests
