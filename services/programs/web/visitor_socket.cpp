#include "services/programs/web/visitor_socket.hpp"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <climits>

namespace dyncal::inline programs::web {
namespace {

constexpr std::string_view speak_tls =
    "HTTP/1.1 400 \r\nContent-Type: text/plain\r\nConnection: close\r\n\r\n"
    "This page is served over TLS: its address begins with https://\n";

int bounded(std::size_t count) {
  return static_cast<int>(std::min<std::size_t>(count, INT_MAX));
}

ssize_t outcome_of_plain(ssize_t count) {
  const bool may_come = count < 0 && (errno == EAGAIN || errno == EINTR);
  return may_come ? VisitorSocket::nothing_yet : std::max<ssize_t>(count, VisitorSocket::has_ended);
}

} // namespace

void VisitorSocket::Free::operator()(ssl_st* session) const {
  SSL_free(session);
}

VisitorSocket::VisitorSocket(drivers::FileDescriptor socket, const TlsCertificate* certificate)
    : socket_(std::move(socket)) {
  if (certificate != nullptr) {
    session_.reset(certificate->begin(socket_.number()));
    if (!session_) {
      socket_.reset(); // never plain text in its place
    }
  }
}

// Hands are shaken before anything is sent: one who is to send first then would be waited for in
// vain, with room to write all the time.
ssize_t VisitorSocket::outcome_of(int count, bool may_wait_to_read) {
  if (count > 0) {
    return count;
  }
  const int why = SSL_get_error(session_.get(), count);
  if (why == SSL_ERROR_WANT_WRITE || (why == SSL_ERROR_WANT_READ && may_wait_to_read)) {
    return nothing_yet;
  }
  if (ERR_GET_REASON(ERR_peek_error()) == SSL_R_HTTP_REQUEST) {
    (void)::send(number(), speak_tls.data(), speak_tls.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  ERR_clear_error();
  return has_ended;
}

ssize_t VisitorSocket::receive(char* data, std::size_t most) {
  if (session_) {
    ERR_clear_error();
    return outcome_of(SSL_read(session_.get(), data, bounded(most)), true);
  }
  return outcome_of_plain(recv(number(), data, most, MSG_DONTWAIT));
}

ssize_t VisitorSocket::send(const char* data, std::size_t count) {
  if (session_) {
    ERR_clear_error();
    return outcome_of(SSL_write(session_.get(), data, bounded(count)), false);
  }
  return outcome_of_plain(::send(number(), data, count, MSG_NOSIGNAL | MSG_DONTWAIT));
}

void VisitorSocket::end_sending() {
  if (session_) {
    SSL_shutdown(session_.get());
    session_.reset();
  }
  shutdown(number(), SHUT_WR);
}

} // namespace dyncal::inline programs::web
