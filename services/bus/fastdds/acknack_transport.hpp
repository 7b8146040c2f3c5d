// A transport of Fast DDS 3 that hands on what it receives with ACKNACKs rewritten
// (screen/acknack_rewriter.hpp), and what is sent as it is. Version 2.9 has screen/ in its place.
#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.hpp>
#include <memory>

namespace dyncal::bus {

// Around `transport`, e.g. UDP.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>
with_acknacks_rewritten(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport);

} // namespace dyncal::bus
