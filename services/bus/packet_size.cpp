#include "services/bus/packet_size.hpp"

#include <algorithm>
#include <optional>

#include "services/bus/host_network.hpp"
#include "services/bus/qos_profiles.hpp"

namespace dyncal::bus {
namespace {

constexpr int headers_bytes = 28; // of IPv4 and UDP
constexpr int alignment = 4;
constexpr int shortest_payload_bytes = 548; // that every host of IPv4 takes

bool is_used(const HostAddress& one, const std::string& wanted, bool is_alone) {
  return wanted.empty() ? is_alone || !one.loopback
                        : wanted == one.interface || wanted == one.address;
}

} // namespace

int packet_payload_bytes(const ParticipantOptions& options) {
  const auto addresses = host_addresses();
  if (options.laboratory == LaboratoryVendors::mixed || !addresses) {
    return max_udp_payload_bytes;
  }
  const bool is_alone =
      std::ranges::all_of(*addresses, [](const HostAddress& one) { return one.loopback; });
  std::optional<int> smallest;
  for (const HostAddress& one : *addresses) {
    const auto mtu = interface_mtu(one.interface);
    if (mtu && is_used(one, options.interface_name, is_alone)) {
      smallest = std::min(smallest.value_or(*mtu), *mtu);
    }
  }
  if (!smallest) {
    return max_udp_payload_bytes;
  }
  return std::clamp(*smallest - headers_bytes, shortest_payload_bytes, longest_payload_bytes) /
         alignment * alignment;
}

} // namespace dyncal::bus
