#include "services/bus/cyclonedds/cyclone_dds_config.hpp"

#include <cstdlib>

#include "services/bus/host_network.hpp"
#include "services/bus/packet_size.hpp"
#include "services/bus/qos_profiles.hpp"

namespace dyncal::bus {
namespace {

std::string element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + text + "</" + name + ">";
}

// Packets with headers, and repairs, stay below the payload; a fragment leaves room for both.
constexpr int repair_bytes = 72;
constexpr int fragment_headers_bytes = 100;
// Of a secured participant (decisions/25-secured-blocks.md).
constexpr int secured_message_bytes = 65'000;
constexpr int secured_fragment_bytes = 64'000;

std::string packets(int message_bytes, int fragment_bytes) {
  return element("MaxMessageSize", std::to_string(message_bytes) + "B") +
         element("FragmentSize", std::to_string(fragment_bytes) + "B");
}

std::string general(const ParticipantOptions& options, const std::string& address, bool secured) {
  std::string text;
  if (!address.empty()) {
    text += element("Interfaces", "<NetworkInterface address=\"" + address + "\"/>");
  }
  // Multicast finds others; samples always travel to each reader by itself, as Fast DDS does it.
  text += element("AllowMulticast", options.multicast ? "spdp" : "false");
  const int message_bytes = packet_payload_bytes(options) - repair_bytes;
  text += secured ? packets(secured_message_bytes, secured_fragment_bytes)
                  : packets(message_bytes, message_bytes - fragment_headers_bytes);
  return element("General", text);
}

std::string discovery(const std::string& own_address, const std::vector<std::string>& peers) {
  // Its own host is always a peer, so that programs on a machine without a network find each other.
  std::string text = "<Peer address=\"" + own_address + "\"/>";
  for (const std::string& peer : peers) {
    text += "<Peer address=\"" + peer + "\"/>";
  }
  // "auto" listens at the ports where Fast DDS and peers look for it.
  return element("Discovery",
                 element("ParticipantIndex", "auto") +
                     element("MaxAutoParticipantIndex", std::to_string(participants_per_host)) +
                     element("LeaseDuration", std::to_string(lease.count()) + " s") +
                     element("SPDPInterval", std::to_string(lease_announcement.count()) + " s") +
                     element("Peers", text));
}

// "Internal" settings are documented for users of Cyclone DDS but may change with its version.
std::string internal() {
  return element("Internal",
                 // Without it Fast DDS does not hear of writers and readers that end.
                 element("GenerateKeyhash", "true") +
                     // Quick repairs: the defaults make a late joiner on Fast DDS wait, and packet
                     // loss stall for seconds.
                     "<HeartbeatInterval min=\"1 ms\" minsched=\"1 ms\" max=\"1 s\">20 "
                     "ms</HeartbeatInterval>" +
                     element("NackDelay", "10 ms") + element("PreEmptiveAckDelay", "10 ms") +
                     element("AckDelay", "5 ms") +
                     element("MaxSampleSize", std::to_string(max_sample_bytes) + "B") +
                     // As much as the host allows: with a minimum it would refuse to start.
                     "<SocketReceiveBufferSize min=\"default\" max=\"" +
                     std::to_string(wanted_receive_buffer_bytes) + "B\"/>");
}

} // namespace

base::Expected<std::string> cyclone_dds_config(const ParticipantOptions& options, bool secured) {
  std::string address;
  if (!options.interface_name.empty()) {
    DYNCAL_TRY(address, interface_address(options.interface_name));
  }
  DYNCAL_TRY(const auto peers, resolve_peers(options.peers));

  std::string config = "<CycloneDDS><Domain Id=\"any\">" + general(options, address, secured) +
                       discovery(address.empty() ? "127.0.0.1" : address, peers) + internal() +
                       "</Domain></CycloneDDS>";
  if (const char* users_own = std::getenv("CYCLONEDDS_URI");
      users_own != nullptr && *users_own != '\0') {
    config += "," + std::string(users_own);
  }
  return config;
}

} // namespace dyncal::bus
