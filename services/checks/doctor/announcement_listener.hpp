// Hears who announces itself by multicast in a DDS domain: the packets of discovery, of whichever
// vendor, beside the DDS implementation of this process.
//
// An RTPS packet begins with "RTPS", the version, the vendor and the prefix of its sender's GUID
// (DDSI-RTPS 8.3.3). The port of discovery is 7400 + 250 times the domain, the group 239.255.0.1.
// Receives nothing else and sends nothing. Belongs to one thread.
#pragma once

#include <set>
#include <string>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline checks::doctor {

class AnnouncementListener {
public:
  // On this interface, by its address; empty: on every one of the host that can multicast. Fails
  // (network) when the port cannot be shared or no interface can.
  [[nodiscard]] static Expected<AnnouncementListener> open(int domain,
                                                           const std::string& interface_address);

  // Reads what has come; never waits.
  void work();
  // Participants heard so far, by their ids (services/bus/discovery.hpp).
  [[nodiscard]] const std::set<std::string>& heard() const { return heard_; }
  // The addresses that they were heard from.
  [[nodiscard]] const std::set<std::string>& heard_from() const { return heard_from_; }

private:
  AnnouncementListener() = default;

  drivers::FileDescriptor socket_;
  std::set<std::string> heard_;
  std::set<std::string> heard_from_;
};

// The sender of an RTPS packet; empty if it is none.
[[nodiscard]] std::string sender_of_packet(const unsigned char* bytes, std::size_t count);

} // namespace dyncal::inline checks::doctor
