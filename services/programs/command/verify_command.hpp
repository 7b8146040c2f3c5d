// `dyncal verify FILE`: what may be believed of a digital calibration certificate.
//
// Prints one line for each question (services/views/certificate/verification.hpp): schema,
// signature, signer, and with --run whether the numbers are those of the stored run. Exit status 0
// only if all hold; else that of the first that does not: 3 not readable, 4 schema, 5 not signed, 6
// signature, 7 signer, 8 numbers; 1 when a file that is named cannot be read. Belongs to one
// thread.
#pragma once

#include <filesystem>

namespace dyncal::inline programs {

struct VerifyCommand {
  std::filesystem::path certificate;
  std::filesystem::path run;     // empty: numbers are not compared
  std::filesystem::path trusted; // empty: nobody is trusted
  std::filesystem::path schema;  // empty: the installed one
};

[[nodiscard]] int run_verify(const VerifyCommand& command);

} // namespace dyncal::inline programs
