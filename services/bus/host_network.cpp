#include "services/bus/host_network.hpp"

#include <arpa/inet.h>
#include <array>
#include <cstring>
#include <filesystem>
#include <ifaddrs.h>
#include <memory>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace dyncal::bus {
namespace {

std::string text_of(const sockaddr* address) {
  char text[INET_ADDRSTRLEN] = {};
  const auto* ipv4 = reinterpret_cast<const sockaddr_in*>(address);
  return inet_ntop(AF_INET, &ipv4->sin_addr, text, sizeof text) != nullptr ? text : "";
}

bool is_inner(const ifaddrs& entry) {
  std::error_code error;
  return (entry.ifa_flags & IFF_POINTOPOINT) != 0 ||
         std::filesystem::exists("/sys/class/net/" + std::string(entry.ifa_name) + "/bridge",
                                 error);
}

} // namespace

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

base::Expected<std::vector<HostAddress>> host_addresses() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    return fail(base::ErrorCode::network,
                "the network interfaces of this machine cannot be listed");
  }
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  std::vector<HostAddress> addresses;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET &&
        (entry->ifa_flags & IFF_UP) != 0) {
      addresses.push_back({.interface = entry->ifa_name,
                           .index = if_nametoindex(entry->ifa_name),
                           .address = text_of(entry->ifa_addr),
                           .loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0,
                           .inner = is_inner(*entry)});
    }
  }
  return addresses;
}

std::string to_string(const HostAddress& address) {
  return address.address + " (" + address.interface + ")";
}

base::Expected<std::string> interface_address(const std::string& name_or_address) {
  DYNCAL_TRY(const auto addresses, host_addresses());
  std::string known;
  for (const HostAddress& one : addresses) {
    if (name_or_address == one.interface || name_or_address == one.address) {
      return one.address;
    }
    known += (known.empty() ? "" : ", ") + one.interface + " (" + one.address + ")";
  }
  return fail(base::ErrorCode::network,
              "network interface \"" + name_or_address +
                  "\" is not one that is up with an IPv4 address on this machine, which has " +
                  known);
}

std::optional<int> interface_mtu(const std::string& name) {
  const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_fd < 0) {
    return std::nullopt;
  }
  ifreq request{};
  std::strncpy(request.ifr_name, name.c_str(), sizeof request.ifr_name - 1);
  const bool is_known = ioctl(socket_fd, SIOCGIFMTU, &request) == 0;
  close(socket_fd);
  return is_known ? std::optional(request.ifr_mtu) : std::nullopt;
}

base::Expected<std::vector<std::string>> resolve_peers(const std::vector<std::string>& hosts) {
  std::vector<std::string> addresses;
  for (const std::string& host : hosts) {
    addrinfo wanted{};
    wanted.ai_family = AF_INET;
    wanted.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    if (const int status = getaddrinfo(host.c_str(), nullptr, &wanted, &found); status != 0) {
      return fail(base::ErrorCode::network,
                  "peer \"" + host + "\" has no IPv4 address: " + gai_strerror(status));
    }
    addresses.push_back(text_of(found->ai_addr));
    freeaddrinfo(found);
  }
  return addresses;
}

int granted_receive_buffer(int wanted_bytes) {
  const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_fd < 0) {
    return 0;
  }
  int granted = 0;
  socklen_t length = sizeof granted;
  const bool known =
      setsockopt(socket_fd, SOL_SOCKET, SO_RCVBUF, &wanted_bytes, sizeof wanted_bytes) == 0 &&
      getsockopt(socket_fd, SOL_SOCKET, SO_RCVBUF, &granted, &length) == 0;
  close(socket_fd);
  // Linux reports twice what was asked for, its own bookkeeping included.
  return known ? granted / 2 : 0;
}

std::string receive_buffer_warning(int wanted_bytes, int granted_bytes) {
  if (granted_bytes == 0 || granted_bytes >= wanted_bytes) {
    return "";
  }
  return "this host allows socket buffers of " + std::to_string(granted_bytes) +
         " bytes only, DDS wants " + std::to_string(wanted_bytes) +
         ": it works, but bursts need repairs; to allow more: sysctl -w net.core.rmem_max=" +
         std::to_string(2 * wanted_bytes);
}

} // namespace dyncal::bus
