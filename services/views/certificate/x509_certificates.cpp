#include "services/views/certificate/x509_certificates.hpp"

#include <ctime>

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/evp.h>

namespace dyncal::inline views {
namespace {

std::string decoded(const std::string& base64_text) {
  std::string compact;
  for (const char c : base64_text) {
    if (c != ' ' && c != '\n' && c != '\r' && c != '\t') {
      compact += c;
    }
  }
  std::string bytes(3 * (compact.size() / 4) + 3, '\0');
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes, as OpenSSL takes them
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                   // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
                                   reinterpret_cast<const unsigned char*>(compact.data()),
                                   static_cast<int>(compact.size()));
  if (size < 0) {
    return {};
  }
  const std::size_t padding = compact.ends_with("==") ? 2 : (compact.ends_with('=') ? 1 : 0);
  bytes.resize(static_cast<std::size_t>(size) - padding);
  return bytes;
}

} // namespace

Certificates certificates_in(const XmlElement& x509_data) {
  Certificates certificates;
  for (const XmlElement& element : x509_data.children()) {
    const std::string bytes = decoded(element.text());
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes, as OpenSSL takes them
    const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
    OpenSslPointer<X509> one(d2i_X509(nullptr, &begin, static_cast<long>(bytes.size())));
    if (!one) {
      ERR_clear_error();
      return {};
    }
    certificates.push_back(std::move(one));
  }
  return certificates;
}

std::string name_text(const X509_NAME* name) {
  const OpenSslPointer<BIO> text(BIO_new(BIO_s_mem()));
  X509_NAME_print_ex(text.get(), name, 0,
                     (XN_FLAG_RFC2253 & ~static_cast<unsigned long>(ASN1_STRFLGS_ESC_MSB)) |
                         XN_FLAG_SEP_CPLUS_SPC);
  return written_to(text.get());
}

std::string end_of_validity(const X509* certificate) {
  std::tm end{};
  ASN1_TIME_to_tm(X509_get0_notAfter(certificate), &end);
  return fmt::format("{:04}-{:02}-{:02}", end.tm_year + 1900, end.tm_mon + 1, end.tm_mday);
}

} // namespace dyncal::inline views
