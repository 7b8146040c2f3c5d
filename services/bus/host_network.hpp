// The host's network: its name, interfaces, addresses of peers, and how large a socket's receive
// buffer may be.
//
// All functions ask the operating system each time, throw nothing and may be called from any
// thread. resolve_peers() may wait for a name server.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::bus {

struct HostAddress {
  std::string interface;
  unsigned index = 0;  // of the interface, another one when it is plugged in again
  std::string address; // IPv4
  bool loopback = false;
  bool inner = false; // a bridge of containers or a tunnel: beside the network of the laboratory

  bool operator==(const HostAddress&) const = default;
};

// Of all interfaces that are up. Fails (network) where they cannot be listed.
[[nodiscard]] base::Expected<std::vector<HostAddress>> host_addresses();

// "10.98.0.1 (lab)"
[[nodiscard]] std::string to_string(const HostAddress& address);

// As the host calls itself; "unknown" if it has no name.
[[nodiscard]] std::string host_name();

// IPv4 address of an interface given by name ("eth0") or by one of this machine's addresses. Fails
// (network) naming those there are.
[[nodiscard]] base::Expected<std::string> interface_address(const std::string& name_or_address);

// Longest packet that an interface sends whole, headers of IP included; empty: not known.
[[nodiscard]] std::optional<int> interface_mtu(const std::string& name);

// IPv4 addresses of hosts given by address or name. Fails (network) naming the first that has none.
[[nodiscard]] base::Expected<std::vector<std::string>>
resolve_peers(const std::vector<std::string>& hosts);

// What the kernel grants a UDP socket that asks for `wanted` bytes (net.core.rmem_max caps it); 0
// if that is not known.
[[nodiscard]] int granted_receive_buffer(int wanted_bytes);

// One sentence for the user when `granted` is too little, else empty.
[[nodiscard]] std::string receive_buffer_warning(int wanted_bytes, int granted_bytes);

} // namespace dyncal::bus
