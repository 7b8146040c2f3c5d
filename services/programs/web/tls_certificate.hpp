// The certificate that the page is served with over TLS, and its key: PEM files, the certificate
// first and then those of the authorities between it and the one that browsers know.
//
// TLS 1.2 and newer, as OpenSSL's own choice of ciphers has it. Fails (bad_file) with the file and
// the reason: it cannot be read, does not belong to the other one, has expired, or is a key that
// everybody on the computer may read. Files are read once; a certificate that is renewed counts
// from the next start. Any thread.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "services/base/error.hpp"

struct ssl_ctx_st; // OpenSSL's SSL_CTX
struct ssl_st;     // OpenSSL's SSL

namespace dyncal::inline programs::web {

class TlsCertificate {
public:
  [[nodiscard]] static Expected<TlsCertificate> read(const std::filesystem::path& certificate,
                                                     const std::filesystem::path& key);

  // For one visitor, as the server's side; null: no memory. The caller frees it (SSL_free).
  [[nodiscard]] ssl_st* begin(int socket) const;
  // "2027-11-26", the last day on which browsers take it.
  [[nodiscard]] const std::string& valid_until() const { return valid_until_; }

private:
  TlsCertificate() = default;

  std::shared_ptr<ssl_ctx_st> context_;
  std::string valid_until_;
};

} // namespace dyncal::inline programs::web
