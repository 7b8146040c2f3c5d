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
constexpr int last_domain = 232;         // whose ports are below 65536
constexpr std::size_t prefix_offset = 8; // behind "RTPS", version and vendor
constexpr std::size_t max_participants = 1000;

int join(int descriptor, in_addr interface_address) {
  ip_mreq request{};
  inet_pton(AF_INET, discovery_group, &request.imr_multiaddr);
  request.imr_interface = interface_address;
  return setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof(request)) == 0 ? 1
                                                                                               : 0;
}

// What one socket joins every one of the host gets that is bound to the group.
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

// At the port of the domain; none where that cannot be shared.
drivers::FileDescriptor listen_in(int domain) {
  drivers::FileDescriptor listening(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int on = 1;
  setsockopt(listening.number(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  setsockopt(listening.number(), SOL_SOCKET, SO_REUSEPORT, &on, sizeof(on));
  setsockopt(listening.number(), IPPROTO_IP, IP_PKTINFO, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain));
  inet_pton(AF_INET, discovery_group, &address.sin_addr); // unicast to this port is not for us
  const bool bound =
      bind(listening.number(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  return bound ? std::move(listening) : drivers::FileDescriptor();
}

std::string interface_of(const msghdr& message) {
  for (cmsghdr* one = CMSG_FIRSTHDR(&message); one != nullptr;
       one = CMSG_NXTHDR(const_cast<msghdr*>(&message), one)) {
    if (one->cmsg_level == IPPROTO_IP && one->cmsg_type == IP_PKTINFO) {
      in_pktinfo info{};
      std::memcpy(&info, CMSG_DATA(one), sizeof(info));
      std::array<char, IF_NAMESIZE> name{};
      const char* found = if_indextoname(static_cast<unsigned>(info.ipi_ifindex), name.data());
      return found == nullptr ? "" : found;
    }
  }
  return "";
}

} // namespace

Expected<AnnouncementListener> AnnouncementListener::open(int domain) {
  AnnouncementListener listener;
  auto own = listen_in(domain);
  if (own.number() < 0) {
    return fail(ErrorCode::network, "the multicast port of discovery cannot be listened at: " +
                                        std::string(std::strerror(errno)));
  }
  if (join_on_every_interface(own.number()) == 0) {
    return fail(ErrorCode::network, "no interface of this host takes part in multicast");
  }
  listener.ports_.push_back({domain, std::move(own)});
  for (int other = 0; other <= last_domain; ++other) {
    if (auto listening = listen_in(other); other != domain && listening.number() >= 0) {
      listener.ports_.push_back({other, std::move(listening)});
    }
  }
  return listener;
}

void AnnouncementListener::work() {
  std::array<char, 2048> buffer{};
  alignas(cmsghdr) std::array<char, 256> extra{};
  for (const Port& port : ports_) {
    while (true) {
      sockaddr_in from{};
      iovec part{buffer.data(), buffer.size()};
      msghdr message{};
      message.msg_name = &from;
      message.msg_namelen = sizeof(from);
      message.msg_iov = &part;
      message.msg_iovlen = 1;
      message.msg_control = extra.data();
      message.msg_controllen = extra.size();
      const ssize_t size = recvmsg(port.socket.number(), &message, 0);
      if (size < 0) {
        break;
      }
      take(port.domain, {buffer.data(), static_cast<std::size_t>(size)}, message);
    }
  }
}

void AnnouncementListener::take(int domain, std::string_view packet, const msghdr& message) {
  const std::string sender = sender_of_packet(packet);
  if (sender.empty() || heard_.size() >= max_participants) {
    return;
  }
  const std::string interface = interface_of(message);
  Announcement& heard = heard_[{sender, interface}];
  sockaddr_in from{};
  std::memcpy(&from, message.msg_name, sizeof(from));
  std::array<char, INET_ADDRSTRLEN> address{};
  inet_ntop(AF_INET, &from.sin_addr, address.data(), address.size());
  const std::string program = program_of_packet(packet);
  AnnouncedIdentity identity = identity_of_packet(packet);
  heard = {domain,         sender,    program.empty() ? heard.program : program,
           address.data(), interface, identity.protection ? std::move(identity) : heard.identity};
}

std::vector<Announcement> AnnouncementListener::heard() const {
  std::vector<Announcement> all;
  all.reserve(heard_.size());
  for (const auto& [key, one] : heard_) {
    all.push_back(one);
  }
  return all;
}

std::string sender_of_packet(std::string_view packet) {
  if (packet.size() < prefix_offset + bus::guid_prefix_bytes || !packet.starts_with("RTPS")) {
    return "";
  }
  return bus::hexadecimal(reinterpret_cast<const unsigned char*>(packet.data()) + prefix_offset,
                          bus::guid_prefix_bytes);
}

std::string program_of_packet(std::string_view packet) {
  const std::size_t at = packet.find("dyncal-");
  if (at == std::string_view::npos) {
    return "";
  }
  const std::string_view rest = packet.substr(at);
  return std::string(rest.substr(0, rest.find_first_not_of("abcdefghijklmnopqrstuvwxyz-")));
}

} // namespace dyncal::inline checks::doctor
