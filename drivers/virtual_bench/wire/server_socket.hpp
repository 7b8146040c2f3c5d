// The instruments' ends of their cables: sockets that never block. Fails as
// drivers/link/tcp_connection.hpp does. Any thread.
#pragma once

#include "drivers/error.hpp"
#include "drivers/link/tcp_connection.hpp"

namespace dyncal::drivers::virtual_bench {

// Port 0 lets the system choose one.
[[nodiscard]] Expected<Descriptor> listen_tcp(const Address& address);
[[nodiscard]] std::uint16_t local_port(const Descriptor& socket);

// A waiting client, or a closed descriptor when there is none.
[[nodiscard]] Descriptor accept_client(const Descriptor& listener);

[[nodiscard]] Expected<Descriptor> connect_udp(const Address& address);

} // namespace dyncal::drivers::virtual_bench
