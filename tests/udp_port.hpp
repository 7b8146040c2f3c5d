// A UDP port for a program that a test starts: free, and no other test's.
//
// Of those above the range that the kernel hands out by itself, so that nobody is given it between
// this look and the program's own.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>
#include <string>

#include "tests/dds_domain.hpp"

namespace dyncal::tests {

inline bool udp_port_is_free(std::uint16_t port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const bool free =
      bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(descriptor);
  return free;
}

// Another one at every call.
inline std::uint16_t own_udp_port() {
  constexpr unsigned first_port = 61'000; // Linux hands out 32768 to 60999
  constexpr unsigned ports = 4000;
  for (unsigned i = 0; i < ports; ++i) {
    const auto port =
        static_cast<std::uint16_t>(first_port + (static_cast<unsigned>(getpid()) + i) % ports);
    if (reserve_for_this_process("udp-port-" + std::to_string(port)) && udp_port_is_free(port)) {
      return port;
    }
  }
  throw std::runtime_error("every UDP port for tests is in use");
}

} // namespace dyncal::tests
