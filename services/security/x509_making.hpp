// Keys (P-256), certificates and lists of revoked ones, as both DDS vendors take them. Any thread.
//
// The subject of a certificate is O=laboratory, OU=salt, CN=name. The salt is drawn until SHA-256
// of the subject begins with the bit that its vendor needs (bus/participant_security.hpp). The
// serial number is 1 and the first 16 bytes of that digest, by which a list of revoked certificates
// tells which participants are meant (revoked_participants.hpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <openssl/sha.h>

#include "services/security/access_documents.hpp"
#include "services/security/pem_file.hpp"

namespace dyncal::inline security {

using SubjectDigest = std::array<unsigned char, SHA256_DIGEST_LENGTH>;

struct Applicant {
  std::string laboratory;
  std::string name;
  bool needs_high_subject = false;
  Validity validity{};
};

[[nodiscard]] OpenSslPointer<EVP_PKEY> make_private_key();
// Signed by itself.
[[nodiscard]] OpenSslPointer<X509> make_authority(const std::string& laboratory, EVP_PKEY& key,
                                                  const Validity& validity);
// Nothing where the authority's key does not sign.
[[nodiscard]] OpenSslPointer<X509> make_certificate(const Applicant& applicant, EVP_PKEY& key,
                                                    X509& authority, EVP_PKEY& authority_key);
// Nothing where the key does not sign. `revoked`: the list before this; may be null.
[[nodiscard]] OpenSslPointer<X509_CRL> make_revoked(const X509_CRL* revoked,
                                                    const Certificates& more, X509& authority,
                                                    EVP_PKEY& authority_key);

[[nodiscard]] std::string pem_text(X509& certificate);
[[nodiscard]] std::string pem_text(X509_CRL& revoked);
[[nodiscard]] std::string pem_text(EVP_PKEY& key);

// "CN=source-acc-1,OU=5f02c1d3,O=Dynamics", as RFC 2253 writes it.
[[nodiscard]] std::string subject_text(const X509& certificate);
// One part of it: NID_commonName, NID_organizationName; empty if there is none.
[[nodiscard]] std::string subject_part(const X509& certificate, int nid);
// SHA-256 of a subject in DER.
[[nodiscard]] SubjectDigest digest_of(const X509_NAME& subject);
// As much of it as the serial number of a certificate has; nothing of one that was not made here.
[[nodiscard]] std::optional<SubjectDigest> digest_in(const ASN1_INTEGER& serial_number);
[[nodiscard]] bool has_high_subject(const X509& certificate);
[[nodiscard]] Validity validity_of(const X509& certificate);
// P-256, or RSA of at least 2048 bits: what both vendors take.
[[nodiscard]] bool is_usable(const EVP_PKEY* key);

} // namespace dyncal::inline security
