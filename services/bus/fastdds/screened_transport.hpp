// A transport of Fast DDS whose received datagrams go through RtpsScreen; sending is left alone.
#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <memory>

namespace dyncal::bus {

// Around `transport`, e.g. UDP.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>
screened(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport);

} // namespace dyncal::bus
