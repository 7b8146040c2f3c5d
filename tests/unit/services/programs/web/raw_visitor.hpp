// A visitor who writes bytes, as a client library would not.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <string>
#include <string_view>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::inline programs::web {

// What comes until the other side closes.
template <class Visitor>
std::string read_to_the_end(const Visitor& visitor) {
  std::string all;
  for (std::string part = visitor.read(); !part.empty(); part = visitor.read()) {
    all += part;
  }
  return all;
}

class RawVisitor {
public:
  // `receive_bytes`: that the kernel takes for him; 0: as many as it likes.
  explicit RawVisitor(int port, int receive_bytes = 0)
      : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval limit{.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket_.number(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    if (receive_bytes > 0) {
      setsockopt(socket_.number(), SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof(receive_bytes));
    }
    is_connected_ = connect(socket_.number(), reinterpret_cast<const sockaddr*>(&address),
                            sizeof(address)) == 0;
  }
  [[nodiscard]] bool is_connected() const { return is_connected_; }
  [[nodiscard]] int number() const { return socket_.number(); }
  // False: the other side has closed.
  bool write(std::string_view bytes) const {
    return send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  // What comes next, `most` bytes at most; empty: the other side has closed.
  [[nodiscard]] std::string read(std::size_t most = 65536) const {
    std::string bytes(most, '\0');
    const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), 0);
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
  }
  [[nodiscard]] std::string read_all() const { return read_to_the_end(*this); }

private:
  drivers::FileDescriptor socket_;
  bool is_connected_ = false;
};

} // namespace dyncal::inline programs::web
