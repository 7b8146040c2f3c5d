#include "services/views/certificate/x509_certificates.hpp"

#include <ctime>

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/pem.h>

#include "services/base/whole_file.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::uintmax_t max_pem_bytes = 1U << 20U;

OpenSslPointer<BIO> reader_of(const std::string& bytes) {
  return OpenSslPointer<BIO>(BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size())));
}

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

Expected<Certificates> read_certificates(const std::filesystem::path& path) {
  DYNCAL_TRY(const auto text, read_whole_file(path, max_pem_bytes));
  const OpenSslPointer<BIO> reader = reader_of(text);
  Certificates certificates;
  while (X509* one = PEM_read_bio_X509(reader.get(), nullptr, nullptr, nullptr)) {
    certificates.emplace_back(one);
  }
  ERR_clear_error();
  if (certificates.empty()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: holds no X.509 certificate in PEM form "
                                                 "(-----BEGIN CERTIFICATE-----)",
                                                 path.string()));
  }
  return certificates;
}

Expected<OpenSslPointer<EVP_PKEY>> read_private_key(const std::filesystem::path& path) {
  DYNCAL_TRY(const auto text, read_whole_file(path, max_pem_bytes));
  const OpenSslPointer<BIO> reader = reader_of(text);
  OpenSslPointer<EVP_PKEY> key(PEM_read_bio_PrivateKey(reader.get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  if (!key) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: holds no private key in PEM form, or its password is wrong",
                            path.string()));
  }
  return key;
}

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
  char* begin = nullptr;
  const long size = BIO_get_mem_data(text.get(), &begin);
  return size > 0 ? std::string(begin, static_cast<std::size_t>(size)) : std::string();
}

std::string end_of_validity(const X509* certificate) {
  std::tm end{};
  ASN1_TIME_to_tm(X509_get0_notAfter(certificate), &end);
  return fmt::format("{:04}-{:02}-{:02}", end.tm_year + 1900, end.tm_mon + 1, end.tm_mday);
}

} // namespace dyncal::inline views
