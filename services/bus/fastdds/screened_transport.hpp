// A transport of Fast DDS whose received datagrams go through MessageCheck and RtpsScreen, and,
// with version 2.9, whose sent ones go through FragmentRepairs. There nothing is sent before the
// participant listens: Fast DDS 2.9.1 announces itself while it still drops what comes, those who
// hear it answer at once and only once, and it would then know nothing of them up to their next
// announcement, a second later.
#pragma once

#include <memory>

#include "services/bus/fastdds/fast_dds_names.hpp"
#ifdef DYNCAL_FAST_DDS_3
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#else
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#endif
#include "services/bus/fastdds/screen/transport_state.hpp"

namespace dyncal::bus {

// Around `transport`, e.g. UDP.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>
screened(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
         std::shared_ptr<TransportState> state);

} // namespace dyncal::bus
