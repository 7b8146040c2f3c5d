#include "services/programs/web/tls_certificate.hpp"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <sys/stat.h>

#include <array>
#include <ctime>

#include <fmt/core.h>

namespace dyncal::inline programs::web {
namespace {

tl::unexpected<Error> refuse(const std::filesystem::path& file, const std::string& why) {
  return fail(ErrorCode::bad_file, fmt::format("{}: {}", file.string(), why));
}

// The newest reason of OpenSSL; the others say what it was called for.
std::string last_reason() {
  const unsigned long code = ERR_peek_last_error();
  ERR_clear_error();
  const char* reason = code == 0 ? nullptr : ERR_reason_error_string(code);
  return reason == nullptr ? "OpenSSL gives no reason" : reason;
}

std::string day_of(const ASN1_TIME& time) {
  std::tm parts{};
  std::array<char, 11> text{};
  if (ASN1_TIME_to_tm(&time, &parts) != 1 ||
      std::strftime(text.data(), text.size(), "%Y-%m-%d", &parts) == 0) {
    return "unknown";
  }
  return text.data();
}

} // namespace

Expected<TlsCertificate> TlsCertificate::read(const std::filesystem::path& certificate,
                                              const std::filesystem::path& key) {
  struct stat status {};
  if (::stat(key.c_str(), &status) == 0 && (status.st_mode & S_IROTH) != 0) {
    return refuse(key, "everybody on this computer can read this key; chmod o= it");
  }
  TlsCertificate made;
  made.context_.reset(SSL_CTX_new(TLS_server_method()), SSL_CTX_free);
  SSL_CTX* context = made.context_.get();
  if (context == nullptr || SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION) != 1) {
    return fail(ErrorCode::bad_file, "OpenSSL serves no TLS here: " + last_reason());
  }
  // A write goes on where the kernel took part of it, from wherever the bytes are then.
  SSL_CTX_set_mode(context, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  if (SSL_CTX_use_certificate_chain_file(context, certificate.c_str()) != 1) {
    return refuse(certificate, "no certificate in PEM can be read: " + last_reason());
  }
  if (SSL_CTX_use_PrivateKey_file(context, key.c_str(), SSL_FILETYPE_PEM) != 1 ||
      SSL_CTX_check_private_key(context) != 1) {
    return refuse(key, fmt::format("no key of {} in PEM can be read: {}", certificate.string(),
                                   last_reason()));
  }
  const ASN1_TIME* last = X509_get0_notAfter(SSL_CTX_get0_certificate(context));
  made.valid_until_ = day_of(*last);
  if (X509_cmp_current_time(last) < 0) {
    return refuse(certificate, fmt::format("this certificate was valid until {}; browsers refuse "
                                           "it: give a new one",
                                           made.valid_until_));
  }
  return made;
}

ssl_st* TlsCertificate::begin(int socket) const {
  SSL* session = SSL_new(context_.get());
  if (session != nullptr) {
    SSL_set_fd(session, socket);
    SSL_set_accept_state(session);
  }
  return session;
}

} // namespace dyncal::inline programs::web
