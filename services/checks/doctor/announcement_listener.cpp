#include "services/checks/doctor/announcement_listener.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cstring>

#include "services/bus/discovery.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr const char* discovery_group = "239.255.0.1";
constexpr std::size_t prefix_offset = 8; // behind "RTPS", version and vendor
constexpr std::size_t max_participants = 1000;

int join(int descriptor, in_addr interface_address) {
  ip_mreq request{};
  inet_pton(AF_INET, discovery_group, &request.imr_multiaddr);
  request.imr_interface = interface_address;
  return setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof(request)) == 0 ? 1
                                                                                               : 0;
}

int join_on_every_interface(int descriptor) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    return 0;
  }
  int joined = 0;
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    constexpr unsigned wanted = IFF_UP | IFF_MULTICAST;
    if (one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET &&
        (one->ifa_flags & wanted) == wanted) {
      sockaddr_in address{};
      std::memcpy(&address, one->ifa_addr, sizeof(address));
      joined += join(descriptor, address.sin_addr);
    }
  }
  freeifaddrs(list);
  return joined;
}

} // namespace

Expected<AnnouncementListener> AnnouncementListener::open(int domain,
                                                          const std::string& interface_address) {
  AnnouncementListener listener;
  listener.socket_ =
      drivers::FileDescriptor(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int descriptor = listener.socket_.number();
  const int on = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEPORT, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain));
  inet_pton(AF_INET, discovery_group, &address.sin_addr); // unicast to this port is not for us
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return fail(ErrorCode::network, "the multicast port of discovery cannot be listened at: " +
                                        std::string(std::strerror(errno)));
  }
  in_addr only{};
  const bool one = inet_pton(AF_INET, interface_address.c_str(), &only) == 1;
  const int joined = one ? join(descriptor, only) : join_on_every_interface(descriptor);
  if (joined == 0) {
    return fail(ErrorCode::network, "no interface of this host takes part in multicast");
  }
  return listener;
}

void AnnouncementListener::work() {
  std::array<unsigned char, 2048> buffer{};
  while (true) {
    sockaddr_in from{};
    socklen_t from_size = sizeof(from);
    const ssize_t size = recvfrom(socket_.number(), buffer.data(), buffer.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0) {
      return;
    }
    const std::string sender = sender_of_packet(buffer.data(), static_cast<std::size_t>(size));
    if (!sender.empty() && heard_.size() < max_participants) {
      heard_.insert(sender);
      std::array<char, INET_ADDRSTRLEN> text{};
      inet_ntop(AF_INET, &from.sin_addr, text.data(), text.size());
      heard_from_.insert(text.data());
    }
  }
}

std::string sender_of_packet(const unsigned char* bytes, std::size_t count) {
  if (count < prefix_offset + bus::guid_prefix_bytes || std::memcmp(bytes, "RTPS", 4) != 0) {
    return "";
  }
  return bus::hexadecimal(bytes + prefix_offset, bus::guid_prefix_bytes);
}

} // namespace dyncal::inline checks::doctor
