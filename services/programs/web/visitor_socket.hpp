// The connection to one visitor, as the server reads and writes it: in plain text or over TLS.
//
// Nothing here waits. What is shaken hands for TLS happens within receive() and send(). A visitor
// who speaks plain HTTP where TLS is spoken is told so in plain HTTP, and has ended. Belongs to one
// thread at a time.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string_view>

#include "drivers/link/file_descriptor.hpp"
#include "services/programs/web/tls_certificate.hpp"

namespace dyncal::inline programs::web {

class VisitorSocket {
public:
  // `certificate`: null for plain text; outlives the call only.
  explicit VisitorSocket(drivers::FileDescriptor socket = drivers::FileDescriptor(),
                         const TlsCertificate* certificate = nullptr);

  [[nodiscard]] int number() const { return socket_.number(); }
  [[nodiscard]] bool is_open() const { return socket_.is_open(); }

  static constexpr ssize_t nothing_yet = -1;
  static constexpr ssize_t has_ended = 0;
  // The count of bytes, or one of the above.
  [[nodiscard]] ssize_t receive(char* data, std::size_t most);
  [[nodiscard]] ssize_t send(const char* data, std::size_t count);
  // Short, into a buffer that is empty unless the visitor does not read: then he is not told.
  void tell(std::string_view text) { (void)send(text.data(), text.size()); }
  // Sends nothing any more; what is received after that is the bytes as they come.
  void end_sending();

private:
  struct Free {
    void operator()(ssl_st* session) const;
  };
  [[nodiscard]] ssize_t outcome_of(int count, bool may_wait_to_read);

  drivers::FileDescriptor socket_;
  std::unique_ptr<ssl_st, Free> session_; // null: plain text
};

} // namespace dyncal::inline programs::web
