#include "services/security/pem_file.hpp"

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/pem.h>

#include "services/base/whole_file.hpp"

namespace dyncal::inline security {
namespace {

constexpr std::uintmax_t max_pem_bytes = 1U << 20U;

} // namespace

OpenSslPointer<BIO> reader_of(const std::string& bytes) {
  return OpenSslPointer<BIO>(BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size())));
}

std::string written_to(BIO* memory) {
  char* begin = nullptr;
  const long size = BIO_get_mem_data(memory, &begin);
  return size > 0 ? std::string(begin, static_cast<std::size_t>(size)) : std::string();
}

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

Expected<OpenSslPointer<X509_CRL>> read_revoked(const std::filesystem::path& path) {
  DYNCAL_TRY(const auto text, read_whole_file(path, max_pem_bytes));
  const OpenSslPointer<BIO> reader = reader_of(text);
  OpenSslPointer<X509_CRL> revoked(PEM_read_bio_X509_CRL(reader.get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  if (!revoked) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: holds no list of revoked certificates in PEM form "
                            "(-----BEGIN X509 CRL-----)",
                            path.string()));
  }
  return revoked;
}

} // namespace dyncal::inline security
