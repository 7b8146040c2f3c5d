// X.509 certificates and keys of OpenSSL as values that free themselves. Any thread.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <openssl/evp.h>
#include <openssl/x509.h>

#include "services/base/error.hpp"
#include "services/views/certificate/xml_document.hpp"

namespace dyncal::inline views {

struct FreeOpenSsl {
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
  void operator()(BIO* bio) const { BIO_free_all(bio); }
  void operator()(X509_STORE* store) const { X509_STORE_free(store); }
  void operator()(X509_STORE_CTX* context) const { X509_STORE_CTX_free(context); }
};

template <class T>
using OpenSslPointer = std::unique_ptr<T, FreeOpenSsl>;
using Certificates = std::vector<OpenSslPointer<X509>>;

// All of a PEM file. Fails (bad_file) when there is none.
[[nodiscard]] Expected<Certificates> read_certificates(const std::filesystem::path& path);

// The private key of a PEM file; a password is asked for on the terminal.
[[nodiscard]] Expected<OpenSslPointer<EVP_PKEY>>
read_private_key(const std::filesystem::path& path);

// Those within an X509Data element, in their order; empty when one cannot be read.
[[nodiscard]] Certificates certificates_in(const XmlElement& x509_data);

// "CN=..., O=..." and "2027-03-01"
[[nodiscard]] std::string name_text(const X509_NAME* name);
[[nodiscard]] std::string end_of_validity(const X509* certificate);

} // namespace dyncal::inline views
