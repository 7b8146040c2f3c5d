// Makes the certificate of a stored run as a file: gathered, written as a DCC, signed, and only
// then held against the schema and its own signature as anybody would who reads it. What fails a
// check is not written; an older file is never overwritten.
//
// Fails as gather_certificate(), sign(), DccSchema and `enter` do. One thread at a time.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "services/base/error.hpp"
#include "services/views/certificate/certificate_contents.hpp"
#include "services/views/certificate/signature.hpp"

namespace dyncal::inline views {

struct CertificateFileRequest {
  CertificateRequest certificate;
  std::optional<SigningKey> key; // nothing: not signed
  std::filesystem::path schema;  // empty: the installed one
  std::filesystem::path output;
  // Before the file is written: its text, whose SHA-256 is that of the file. Empty: nobody asks.
  std::function<Expected<void>(const CertificateFileRequest&, const CertificateContents&,
                               const std::string&)>
      enter{};
};

// What was certified, for a line to the user.
[[nodiscard]] Expected<CertificateContents>
write_certificate(const CertificateFileRequest& request);

} // namespace dyncal::inline views
