#include "services/programs/command/verify_command.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/certificate/verification.hpp"

namespace dyncal::inline programs {

int run_verify(const VerifyCommand& command) {
  const auto findings = [&] {
    const WorkProgress progress("verifying");
    return verify({.certificate = command.certificate,
                   .run = command.run,
                   .trusted = command.trusted,
                   .schema = command.schema});
  }();
  if (!findings) {
    return report_error(findings.error());
  }
  for (const VerificationFinding& finding : *findings) {
    fmt::print("{:<10} {}: {}\n", to_string(finding.question), finding.holds ? "ok" : "FAILED",
               one_line(finding.sentence));
  }
  const auto first =
      std::find_if(findings->begin(), findings->end(),
                   [](const VerificationFinding& finding) { return !finding.holds; });
  if (first == findings->end()) {
    fmt::print("{} is verified\n", command.certificate.string());
    return 0;
  }
  fmt::print(stderr, "{} is NOT verified\n", command.certificate.string());
  return static_cast<int>(first->question);
}

} // namespace dyncal::inline programs
