// Hears who announces itself by multicast, in every DDS domain and on every interface of the host:
// the packets of discovery, of whichever vendor, beside the DDS implementation of this process. So
// it shows programs that a wrong domain or interface keeps apart.
//
// An RTPS packet begins with "RTPS", the version, the vendor and the prefix of its sender's GUID
// (DDSI-RTPS 8.3.3). The port of discovery is 7400 + 250 times the domain, the group 239.255.0.1.
// Receives nothing else and sends nothing. Belongs to one thread.
#pragma once

#include <sys/socket.h>

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/error.hpp"
#include "services/checks/doctor/announced_identity.hpp"

namespace dyncal::inline checks::doctor {

struct Announcement {
  int domain = 0;
  std::string participant{}; // its id (services/bus/discovery.hpp)
  std::string program{};     // "dyncal-analysis"; empty: none of dyncal's
  std::string address{};     // that it came from
  std::string interface {};  // of this host, that it came by
  AnnouncedIdentity identity{};
};

class AnnouncementListener {
public:
  // Fails (network) when the port of this domain cannot be shared, or no interface of the host can
  // multicast. Another domain whose port is not free is left out.
  [[nodiscard]] static Expected<AnnouncementListener> open(int domain);

  // Reads what has come; never waits.
  void work();
  // So far, each participant once an interface.
  [[nodiscard]] std::vector<Announcement> heard() const;

private:
  struct Port {
    int domain;
    drivers::FileDescriptor socket;
  };

  AnnouncementListener() = default;
  void take(int domain, std::string_view packet, const msghdr& message);

  std::vector<Port> ports_;
  std::map<std::pair<std::string, std::string>, Announcement> heard_; // participant, interface
};

// The sender of an RTPS packet; empty if it is none.
[[nodiscard]] std::string sender_of_packet(std::string_view packet);

// The name of a program of dyncal, as an announcement of either vendor has it; empty if none.
[[nodiscard]] std::string program_of_packet(std::string_view packet);

} // namespace dyncal::inline checks::doctor
