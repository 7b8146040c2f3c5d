// Who else is in a DDS domain, as discovery tells it, whether they use dyncal or not: for people
// who look for the reason why two programs do not talk. Plain data.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace dyncal::bus {

struct DiscoveredParticipant {
  std::string id;     // the prefix of its GUID in hexadecimal, as in the header of its packets
  std::string name;   // with process and host (participant_name.hpp); may be empty
  std::string vendor; // its name, or its number
};

enum class EndpointKind { writer, reader };

// In the order of the specification: who offers a later one offers those before it, too.
enum class Liveliness { automatic, manual_by_participant, manual_by_topic };
enum class AccessScope { instance, topic, group };
enum class DestinationOrder { by_reception, by_source };

struct DiscoveredEndpoint {
  std::string participant; // its id
  EndpointKind kind = EndpointKind::writer;
  std::string topic;
  std::string type;
  std::vector<std::string> partitions; // of the default partition: one empty name
  bool reliable = false;
  bool transient_local = false; // or more durable
  bool exclusive_ownership = false;
  double deadline_s = std::numeric_limits<double>::infinity();
  double latency_budget_s = 0.0;
  Liveliness liveliness = Liveliness::automatic;
  double lease_s = std::numeric_limits<double>::infinity(); // of its liveliness
  AccessScope access_scope = AccessScope::instance;
  bool coherent_access = false;
  bool ordered_access = false;
  DestinationOrder destination_order = DestinationOrder::by_reception;
  // A writer sends in the first one, a reader takes each: 0 XCDR1, 1 XML, 2 XCDR2. Empty: XCDR1.
  std::vector<int> representations = {};
};

struct Discovery {
  std::vector<DiscoveredParticipant> participants;
  std::vector<DiscoveredEndpoint> endpoints;
};

// By the vendor's number, which leads every GUID.
[[nodiscard]] std::string vendor_of(const std::string& id);

// Bytes in hexadecimal.
[[nodiscard]] std::string hexadecimal(const unsigned char* bytes, std::size_t count);

inline constexpr std::size_t guid_prefix_bytes = 12;

} // namespace dyncal::bus
