// A transport of Fast DDS whose received datagrams go through MessageCheck and RtpsScreen, and
// whose sent ones through FragmentRepairs. Nothing is sent before the participant listens: Fast
// DDS 2.9.1 announces itself while it still drops what comes, those who hear it answer at once and
// only once, and it would then know nothing of them up to their next announcement, a second later.
#pragma once

#include <atomic>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <memory>

#include "services/bus/refused_packets.hpp"

namespace dyncal::bus {

// What the transports of a participant share with who makes it. Safe from several threads.
struct TransportState {
  explicit TransportState(std::shared_ptr<RefusedPackets> counter) : refused(std::move(counter)) {}

  std::shared_ptr<RefusedPackets> refused; // counts what is dropped
  std::atomic<bool> listens{false};        // set when the participant is there
};

// Around `transport`, e.g. UDP.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>
screened(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
         std::shared_ptr<TransportState> state);

} // namespace dyncal::bus
