// A transport of Fast DDS whose received datagrams go through MessageCheck and RtpsScreen; sending
// is left alone.
#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <memory>

#include "services/bus/refused_packets.hpp"

namespace dyncal::bus {

// Around `transport`, e.g. UDP. What is dropped is counted in `refused`.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>
screened(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
         std::shared_ptr<RefusedPackets> refused);

} // namespace dyncal::bus
