// What an announcement of DDS discovery tells of how its program is secured: it is in clear (OMG
// DDS Security 1.1, 7.4.1.4). Fast DDS announces whose authority a certificate is of, Cyclone DDS
// does not; both announce how they protect discovery. Plain data; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace dyncal::inline checks::doctor {

struct AnnouncedIdentity {
  std::string authority{}; // its subject, "/O=Lab/OU=5f02c1d3/CN=authority"; empty: not announced
  // Protection of the participant, of its plug-ins; nothing: not announced.
  std::optional<std::uint64_t> protection{};
};

// Of a whole packet, in the order of bytes that both vendors use.
[[nodiscard]] AnnouncedIdentity identity_of_packet(std::string_view packet);

} // namespace dyncal::inline checks::doctor
