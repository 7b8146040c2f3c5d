// A transport of Fast DDS whose received datagrams go through MessageCheck and RtpsScreen, and
// whose sent ones through FragmentRepairs. Nothing is sent before the participant listens: Fast
// DDS 2.9.1 announces itself while it still drops what comes, those who hear it answer at once and
// only once, and it would then know nothing of them up to their next announcement, a second later.
#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <memory>

#include "services/bus/fastdds/screen/transport_state.hpp"

namespace dyncal::bus {

// Around `transport`, e.g. UDP.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>
screened(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
         std::shared_ptr<TransportState> state);

} // namespace dyncal::bus
