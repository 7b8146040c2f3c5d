// What was observed of this host, for check_host(): limits of its network, and room for results.
//
// Asks the operating system each time, changes nothing but that it opens sockets for a moment. Any
// thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/checks/doctor/send_queues.hpp"
#include "services/checks/doctor/trial_connections.hpp"

namespace dyncal::inline checks::doctor {

struct HostInterface {
  std::string name;
  std::string address; // IPv4
  int mtu = 0;
  bool loopback = false;
  int prefix_bits = 0;        // of its subnet
  bool multicast = false;     // the interface says that it can
  bool reaches_itself = true; // a datagram from one socket of this host to another, by its address
};

struct UdpCounters { // since the host was started; /proc/net/snmp
  std::uint64_t received = 0;
  std::uint64_t without_room = 0; // RcvbufErrors
  std::uint64_t damaged = 0;      // InCsumErrors
};

struct HostView {
  int receive_buffer_bytes = 0;          // that a socket is granted
  std::vector<HostInterface> interfaces; // that are up and have an IPv4 address
  std::vector<std::string> without_ipv4; // interfaces that are up and have IPv6 alone
  // How often the link of an interface has changed between down and up, since it is there.
  std::map<std::string, unsigned> link_changes_before;
  std::map<std::string, unsigned> link_changes_after;
  std::map<std::string, SendQueue> queues_before; // by interface
  std::map<std::string, SendQueue> queues_after;
  // Addresses that announcements came from, and no answer; where nothing came, those of peers.
  std::map<std::string, TriedHost> tried;
  std::string used_address{}; // of the one interface that this program uses; empty: of all
  std::map<std::string, std::string> dds_variables{}; // of check_variables(), that are set
  std::optional<bool> multicast_loops; // a datagram to a group comes back; nothing: not tried
  std::optional<UdpCounters> udp_before;
  std::optional<UdpCounters> udp_after;
  std::filesystem::path output_folder;
  std::optional<std::uint64_t> free_bytes; // there; nothing: not known
  bool output_writable = false;
};

// All but what is told afterwards, and `tried`.
[[nodiscard]] HostView look_at_host(const std::filesystem::path& output_folder);
[[nodiscard]] std::optional<UdpCounters> udp_counters();
[[nodiscard]] std::map<std::string, unsigned> link_changes();

} // namespace dyncal::inline checks::doctor
