// Certificates and private keys in PEM files, as values of OpenSSL that free themselves. Any
// thread.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <openssl/asn1.h>
#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include "services/base/error.hpp"

namespace dyncal::inline security {

struct FreeOpenSsl {
  void operator()(ASN1_STRING* value) const { ASN1_STRING_free(value); } // of time, too
  void operator()(BIO* bio) const { BIO_free_all(bio); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
  void operator()(PKCS7* message) const { PKCS7_free(message); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(X509_CRL* revoked) const { X509_CRL_free(revoked); }
  void operator()(X509_STORE* store) const { X509_STORE_free(store); }
  void operator()(X509_STORE_CTX* context) const { X509_STORE_CTX_free(context); }
};

template <class T>
using OpenSslPointer = std::unique_ptr<T, FreeOpenSsl>;
using Certificates = std::vector<OpenSslPointer<X509>>;

// What reads these bytes, which outlive it.
[[nodiscard]] OpenSslPointer<BIO> reader_of(const std::string& bytes);
// What was written to memory.
[[nodiscard]] std::string written_to(BIO* memory);

// All of a PEM file. Fails (bad_file) when there is none.
[[nodiscard]] Expected<Certificates> read_certificates(const std::filesystem::path& path);

// The private key of a PEM file; a password is asked for on the terminal.
[[nodiscard]] Expected<OpenSslPointer<EVP_PKEY>>
read_private_key(const std::filesystem::path& path);

// The list of revoked certificates of a PEM file.
[[nodiscard]] Expected<OpenSslPointer<X509_CRL>> read_revoked(const std::filesystem::path& path);

} // namespace dyncal::inline security
