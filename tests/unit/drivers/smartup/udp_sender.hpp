// A UDP socket of its own, as each unit has one. For tests.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <vector>

namespace dyncal::tests {

class UdpSender {
public:
  explicit UdpSender(std::uint16_t port)
      : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_port = htons(port);
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~UdpSender() { close(descriptor_); }
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  // True when the whole datagram has gone.
  bool send(const std::vector<std::uint8_t>& bytes) {
    return sendto(descriptor_, bytes.data(), bytes.size(), 0,
                  reinterpret_cast<const sockaddr*>(&address_),
                  sizeof address_) == static_cast<ssize_t>(bytes.size());
  }

private:
  int descriptor_;
  sockaddr_in address_{};
};

} // namespace dyncal::tests
