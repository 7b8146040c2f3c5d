#include "services/checks/doctor/host_view.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "drivers/link/file_descriptor.hpp"
#include "services/bus/host_network.hpp"
#include "services/bus/qos_profiles.hpp"
#include "services/checks/doctor/dds_variables.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr int answer_limit_ms = 200;
constexpr const char* trial_group = "239.255.0.2"; // beside that of discovery, 239.255.0.1

class UdpSocket {
public:
  // At any free port of all addresses; 0: not possible.
  [[nodiscard]] std::uint16_t listen() const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    socklen_t size = sizeof(address);
    const bool bound =
        bind(socket_.number(), reinterpret_cast<sockaddr*>(&address), size) == 0 &&
        getsockname(socket_.number(), reinterpret_cast<sockaddr*>(&address), &size) == 0;
    return bound ? ntohs(address.sin_port) : std::uint16_t{0};
  }
  [[nodiscard]] bool join(const char* group) const {
    ip_mreqn request{};
    inet_pton(AF_INET, group, &request.imr_multiaddr);
    return setsockopt(socket_.number(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof(request)) ==
           0;
  }
  [[nodiscard]] bool send(const std::string& host, std::uint16_t port) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    inet_pton(AF_INET, host.c_str(), &address.sin_addr);
    return sendto(socket_.number(), "dyncal", 6, 0, reinterpret_cast<const sockaddr*>(&address),
                  sizeof(address)) == 6;
  }
  [[nodiscard]] bool receive() const {
    pollfd readable{socket_.number(), POLLIN, 0};
    std::array<char, 16> buffer{};
    return poll(&readable, 1, answer_limit_ms) > 0 &&
           recv(socket_.number(), buffer.data(), buffer.size(), 0) == 6;
  }

private:
  drivers::FileDescriptor socket_{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
};

bool reaches(const std::string& address) {
  const UdpSocket receiver;
  const UdpSocket sender;
  const std::uint16_t port = receiver.listen();
  return port != 0 && sender.send(address, port) && receiver.receive();
}

std::optional<bool> multicast_comes_back() {
  const UdpSocket receiver;
  const UdpSocket sender;
  const std::uint16_t port = receiver.listen();
  if (port == 0 || !receiver.join(trial_group)) {
    return std::nullopt;
  }
  return sender.send(trial_group, port) && receiver.receive();
}

// Up, not loopback, and with an address of its own, but of IPv6 alone.
std::vector<std::string> interfaces_without_ipv4() {
  std::set<std::string> ipv4;
  std::set<std::string> ipv6;
  std::set<std::string> of_others;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    return {};
  }
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr != nullptr && (one->ifa_flags & IFF_UP) != 0 &&
        (one->ifa_flags & IFF_LOOPBACK) == 0) {
      const auto family = one->ifa_addr->sa_family;
      (family == AF_INET ? ipv4 : family == AF_INET6 ? ipv6 : of_others).insert(one->ifa_name);
    }
  }
  freeifaddrs(list);
  std::vector<std::string> without;
  std::set_difference(ipv6.begin(), ipv6.end(), ipv4.begin(), ipv4.end(),
                      std::back_inserter(without));
  return without;
}

int prefix_bits_of(const sockaddr* netmask) {
  sockaddr_in mask{};
  if (netmask != nullptr) {
    std::memcpy(&mask, netmask, sizeof(mask));
  }
  return std::popcount(mask.sin_addr.s_addr);
}

std::vector<HostInterface> interfaces_of_host() {
  std::vector<HostInterface> interfaces;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    return interfaces;
  }
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET ||
        (one->ifa_flags & IFF_UP) == 0) {
      continue;
    }
    std::array<char, INET_ADDRSTRLEN> text{};
    sockaddr_in address{};
    std::memcpy(&address, one->ifa_addr, sizeof(address));
    inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    interfaces.push_back({.name = one->ifa_name,
                          .address = text.data(),
                          .mtu = bus::interface_mtu(one->ifa_name).value_or(0),
                          .loopback = (one->ifa_flags & IFF_LOOPBACK) != 0,
                          .prefix_bits = prefix_bits_of(one->ifa_netmask),
                          .multicast = (one->ifa_flags & IFF_MULTICAST) != 0,
                          .reaches_itself = reaches(text.data())});
  }
  freeifaddrs(list);
  return interfaces;
}

} // namespace

std::optional<UdpCounters> udp_counters() {
  std::ifstream file("/proc/net/snmp");
  std::vector<std::string> names;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string protocol;
    words >> protocol;
    if (protocol != "Udp:") {
      continue;
    }
    if (names.empty()) { // the first of two lines has the names
      for (std::string word; words >> word;) {
        names.push_back(word);
      }
      continue;
    }
    UdpCounters counters;
    for (const std::string& name : names) {
      std::uint64_t value = 0;
      words >> value;
      counters.received = name == "InDatagrams" ? value : counters.received;
      counters.without_room = name == "RcvbufErrors" ? value : counters.without_room;
      counters.damaged = name == "InCsumErrors" ? value : counters.damaged;
    }
    return counters;
  }
  return std::nullopt;
}

std::map<std::string, unsigned> link_changes() {
  std::map<std::string, unsigned> changes;
  std::error_code error;
  for (const auto& one : std::filesystem::directory_iterator("/sys/class/net", error)) {
    std::ifstream file(one.path() / "carrier_changes");
    if (unsigned count = 0; file >> count) {
      changes[one.path().filename().string()] = count;
    }
  }
  return changes;
}

HostView look_at_host(const std::filesystem::path& output_folder) {
  HostView view;
  view.receive_buffer_bytes = bus::granted_receive_buffer(bus::wanted_receive_buffer_bytes);
  view.interfaces = interfaces_of_host();
  view.dds_variables = dds_variables();
  view.without_ipv4 = interfaces_without_ipv4();
  view.link_changes_before = link_changes();
  view.queues_before = send_queues();
  view.multicast_loops = multicast_comes_back();
  view.udp_before = udp_counters();
  std::error_code error;
  view.output_folder = std::filesystem::weakly_canonical(output_folder, error);
  const auto space = std::filesystem::space(output_folder, error);
  if (!error) {
    view.free_bytes = space.available;
  }
  view.output_writable = access(output_folder.c_str(), W_OK) == 0;
  return view;
}

} // namespace dyncal::inline checks::doctor
