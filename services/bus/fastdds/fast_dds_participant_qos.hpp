// How a Fast DDS participant reaches others: UDP only, discovery by multicast and by peers, short
// leases.
//
// A profiles file of the user comes first: when FASTRTPS_DEFAULT_PROFILES_FILE (or
// DEFAULT_FASTRTPS_PROFILES.xml in the working directory) has a default participant profile, that
// profile is taken as it is, and the options for peers, multicast and interface have no effect,
// which is said; security comes from the options all the same. Writers and readers never take
// anything from the file: their QoS is the contract's.
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <memory>

#include "services/bus/bus.hpp"
#include "services/bus/fastdds/screen/transport_state.hpp"
#include "services/bus/participant_security.hpp"

namespace dyncal::bus {

// `security` may be null. `state` is shared by its transports, which send nothing before it says
// that the participant listens. Fails (network) on an interface or peer that does not exist.
[[nodiscard]] base::Expected<eprosima::fastdds::dds::DomainParticipantQos>
fast_dds_participant_qos(const ParticipantOptions& options, const SecurityFiles* security,
                         const std::shared_ptr<TransportState>& state);

} // namespace dyncal::bus
