// Who else is in a DDS domain, as discovery tells it, whether they use dyncal or not: for people
// who look for the reason why two programs do not talk. Plain data.
#pragma once

#include <string>
#include <vector>

namespace dyncal::bus {

struct DiscoveredParticipant {
  std::string id;     // the prefix of its GUID in hexadecimal, as in the header of its packets
  std::string name;   // as it calls itself; may be empty
  std::string vendor; // "Fast DDS", "Cyclone DDS", or its number
};

enum class EndpointKind { writer, reader };

struct DiscoveredEndpoint {
  std::string participant; // its id
  EndpointKind kind = EndpointKind::writer;
  std::string topic;
  std::string type;
  std::vector<std::string> partitions; // of the default partition: one empty name
  bool reliable = false;
  bool transient_local = false; // or more durable
};

struct Discovery {
  std::vector<DiscoveredParticipant> participants;
  std::vector<DiscoveredEndpoint> endpoints;
};

// "010f..." is "Fast DDS": the vendor's number leads every GUID.
[[nodiscard]] std::string vendor_of(const std::string& id);

// Bytes in hexadecimal.
[[nodiscard]] std::string hexadecimal(const unsigned char* bytes, std::size_t count);

inline constexpr std::size_t guid_prefix_bytes = 12;

} // namespace dyncal::bus
