// How a Fast DDS participant reaches others: UDP only, discovery by multicast and by peers, short
// leases.
//
// A profiles file of the user comes first: when FASTRTPS_DEFAULT_PROFILES_FILE (or
// DEFAULT_FASTRTPS_PROFILES.xml in the working directory) has a default participant profile, that
// profile is taken as it is, and the options for peers, multicast and interface have no effect,
// which is said. Writers and readers never take anything from the file: their QoS is the
// contract's.
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <memory>

#include "services/bus/bus.hpp"
#include "services/bus/fastdds/screen/transport_state.hpp"

namespace dyncal::bus {

// `state` is shared by its transports, which send nothing before it says that the participant
// listens. Fails (network) on an interface or peer that does not exist.
[[nodiscard]] base::Expected<eprosima::fastdds::dds::DomainParticipantQos>
fast_dds_participant_qos(const ParticipantOptions& options,
                         const std::shared_ptr<TransportState>& state);

} // namespace dyncal::bus
