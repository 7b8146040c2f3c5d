// `dyncal verify FILE`: what may be believed of a digital calibration certificate.
//
// Prints one line for each question (services/views/certificate/verification.hpp): schema,
// signature, signer, and with --run whether the numbers are those of the stored run. Exit status 0
// only if all hold; else that of the first that does not: 3 not readable, 4 schema, 5 not signed, 6
// signature, 7 signer, 8 numbers; 1 when a file that is named cannot be read. Belongs to one
// thread.
#include <algorithm>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/certificate/verification.hpp"

namespace dyncal::inline programs {
namespace {

void add_verify(CLI::App& command, VerificationRequest& verify) {
  command.add_option("FILE", verify.certificate, "certificate (DCC, XML)")->required();
  take_run(command.add_option("--run", verify.run,
                              "run folder or result file that its numbers should be those of"));
  command.add_option("--trust", verify.trusted,
                     "X.509 certificates, PEM, of the laboratory or its CA, one or more");
  command.add_option("--schema", verify.schema,
                     "dcc.xsd to hold it against (default: the installed one)");
}

Expected<int> run_verify(const VerificationRequest& request) {
  DYNCAL_TRY(const auto findings,
             with_progress("verifying", [&](const auto&) { return verify(request); }));
  for (const VerificationFinding& finding : findings) {
    fmt::print("{:<10} {}: {}\n", to_string(finding.question), finding.holds ? "ok" : "FAILED",
               one_line(finding.sentence));
  }
  const auto first = std::ranges::find(findings, false, &VerificationFinding::holds);
  if (first == findings.end()) {
    fmt::print("{} is verified\n", request.certificate.string());
    return 0;
  }
  fmt::print(stderr, "{} is NOT verified\n", request.certificate.string());
  return static_cast<int>(first->question);
}

const Command verify_command{
    230, "verify", "check a digital calibration certificate: schema, signature, signer, numbers",
    add_verify, run_verify};

} // namespace
} // namespace dyncal::inline programs
