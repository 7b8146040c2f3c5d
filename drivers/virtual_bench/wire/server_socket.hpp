// The instruments' ends of their cables: sockets that never block. Fails: not_found (no such host),
// refused (the address cannot be listened on). Any thread.
#pragma once

#include "drivers/error.hpp"
#include "drivers/link/address.hpp"
#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers::virtual_bench {

// Port 0 lets the system choose one.
[[nodiscard]] Expected<FileDescriptor> listen_tcp(const Address& address);
[[nodiscard]] std::uint16_t local_port(const FileDescriptor& socket);

// A waiting client, or a closed descriptor when there is none.
[[nodiscard]] FileDescriptor accept_client(const FileDescriptor& listener);

[[nodiscard]] Expected<FileDescriptor> connect_udp(const Address& address);

} // namespace dyncal::drivers::virtual_bench
