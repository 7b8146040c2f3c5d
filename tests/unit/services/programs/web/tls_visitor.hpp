// A visitor over TLS who takes any certificate, and certificates made for one test.
#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "tests/unit/services/programs/web/raw_visitor.hpp"

namespace dyncal::inline programs::web {

struct CertificateFiles {
  std::filesystem::path certificate;
  std::filesystem::path key;
};

// Signed by itself, of a key of P-256, valid for `valid_s` from a day ago.
inline CertificateFiles make_certificate(const std::filesystem::path& folder,
                                         const std::string& name, long valid_s) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> made(X509_new(), X509_free);
  constexpr long day_s = 86'400;
  X509_gmtime_adj(X509_getm_notBefore(made.get()), -day_s);
  X509_gmtime_adj(X509_getm_notAfter(made.get()), valid_s - day_s);
  X509_set_pubkey(made.get(), key.get());
  X509_sign(made.get(), key.get(), EVP_sha256());
  CertificateFiles files{folder / (name + ".pem"), folder / (name + "-key.pem")};
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  PEM_write_X509(File(std::fopen(files.certificate.c_str(), "w"), std::fclose).get(), made.get());
  PEM_write_PrivateKey(File(std::fopen(files.key.c_str(), "w"), std::fclose).get(), key.get(),
                       nullptr, nullptr, 0, nullptr, nullptr);
  std::filesystem::permissions(files.key, std::filesystem::perms::owner_read);
  return files;
}

class TlsVisitor {
public:
  explicit TlsVisitor(int port)
      : connection_(port), context_(SSL_CTX_new(TLS_client_method()), SSL_CTX_free),
        session_(SSL_new(context_.get()), SSL_free) {
    SSL_set_fd(session_.get(), connection_.number());
    is_connected_ = SSL_connect(session_.get()) == 1;
  }
  [[nodiscard]] bool is_connected() const { return is_connected_; }
  bool write(const std::string& bytes) const {
    return SSL_write(session_.get(), bytes.data(), static_cast<int>(bytes.size())) ==
           static_cast<int>(bytes.size());
  }
  // What comes next; empty: the other side has closed.
  [[nodiscard]] std::string read() const {
    std::string bytes(65536, '\0');
    const int count = SSL_read(session_.get(), bytes.data(), static_cast<int>(bytes.size()));
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
  }
  [[nodiscard]] std::string read_all() const { return read_to_the_end(*this); }

private:
  RawVisitor connection_;
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_;
  std::unique_ptr<SSL, decltype(&SSL_free)> session_;
  bool is_connected_ = false;
};

} // namespace dyncal::inline programs::web
