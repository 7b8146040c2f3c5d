// How a Cyclone DDS domain reaches others, as the XML text it is configured with: UDP only,
// discovery by multicast and by peers, short leases, packets that fit an Ethernet frame; where it
// is secured, messages that IP cuts (participant_security.hpp).
//
// CYCLONEDDS_URI of the user comes last and so wins, setting by setting; its network interfaces and
// peers are added to those of the options.
#pragma once

#include <string>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

// Fails (network) on an interface or peer that does not exist.
[[nodiscard]] base::Expected<std::string> cyclone_dds_config(const ParticipantOptions& options,
                                                             bool secured);

} // namespace dyncal::bus
