// What the transports of a participant share with who makes it. Safe from several threads.
#pragma once

#include <atomic>
#include <memory>

#include "services/bus/refused_packets.hpp"

namespace dyncal::bus {

struct TransportState {
  explicit TransportState(std::shared_ptr<RefusedPackets> counter) : refused(std::move(counter)) {}

  std::shared_ptr<RefusedPackets> refused; // counts what is dropped
  std::atomic<bool> listens{false};        // set when the participant is there
};

} // namespace dyncal::bus
