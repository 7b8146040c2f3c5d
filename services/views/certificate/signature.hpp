// XML signature of a DCC (xmlsec1 with OpenSSL): one enveloped signature over the whole document,
// the last element of its root, as the schema of the DCC has it. RSA (2048 bits or more) or ECDSA
// with SHA-256 or better, exclusive canonicalisation, X.509 certificates within.
//
// Checking takes nothing on trust: only this one form is accepted (one reference, to the whole
// document; no objects, no other transforms, no keys but those of certificates), so that a moved,
// doubled or wrapped signature, or one over a part, is refused before any arithmetic. Whether the
// signer is known is asked apart: his certificate must lead to one of those that the reader trusts,
// be meant for signatures, and have been valid on the day of issue.
//
// Each failure of a check is one of SignatureProblem with a sentence. One thread at a time.
#pragma once

#include <filesystem>
#include <string>

#include "services/base/error.hpp"
#include "services/views/certificate/xml_document.hpp"

namespace dyncal::inline views {

struct SigningKey {
  std::string key; // PEM file, whose password is asked for on the terminal, or in a token (pkcs11:)
  std::filesystem::path certificate; // PEM: the signer's first, then others up to the CA
};

// Appends the signature. Fails (bad_file) when a file cannot be read, key and certificate do not
// belong together, or the key is of another kind.
[[nodiscard]] Expected<void> sign(XmlDocument& document, const SigningKey& key);

enum class SignatureProblem {
  not_signed, // no signature
  not_intact, // not of the accepted form, or the document is not the one that was signed
  not_trusted // intact, but the signer is not known
};

using SignatureFailure = Failure<SignatureProblem>;

struct Signer {
  std::string subject; // "CN=..., O=..."
  std::string issuer;
  std::string valid_until; // YYYY-MM-DD
  std::string algorithm;   // "RSA-SHA256"
};

// The signer of an intact signature, trusted by nobody yet.
[[nodiscard]] tl::expected<Signer, SignatureFailure> check_signature(const XmlDocument& document);

// Whether the certificate of the signature leads to one of `trusted` (PEM, one or more) on the day
// of issue, YYYY-MM-DD. Fails (not_trusted). REQUIRES: check_signature() found it intact.
[[nodiscard]] tl::expected<void, SignatureFailure>
check_signer(const XmlDocument& document, const std::filesystem::path& trusted,
             const std::string& day_of_issue);

} // namespace dyncal::inline views
