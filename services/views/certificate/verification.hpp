// What `dyncal verify` asks of a certificate, in this order: is it XML that may be read, is it a
// valid DCC, is its signature intact, is its signer known, are its numbers those of the stored run.
// Every question that can still be asked is answered; a certificate is verified if all are.
//
// Plain functions; one thread at a time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline views {

// The exit status of `dyncal verify` is that of the first failure.
enum class Verification {
  readable = 3,
  schema = 4,
  is_signed = 5,
  signature = 6,
  signer = 7,
  numbers = 8,
  measured = 9, // of the result; asked by who may look into the records (services/records)
  issued = 10   // by the register; likewise
};

struct VerificationFinding {
  Verification question = Verification::readable;
  bool holds = false;
  std::string sentence;
};

struct VerificationRequest {
  std::filesystem::path certificate;
  std::filesystem::path run;     // empty: numbers are not compared
  std::filesystem::path trusted; // PEM; empty: nobody is trusted
  std::filesystem::path schema;  // empty: the installed one
};

// Fails (bad_file) when a file that is asked for cannot be read at all.
[[nodiscard]] Expected<std::vector<VerificationFinding>> verify(const VerificationRequest& request);

// For people: "schema".
[[nodiscard]] const char* to_string(Verification question);

} // namespace dyncal::inline views
