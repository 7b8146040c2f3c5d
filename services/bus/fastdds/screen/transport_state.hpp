// What the transports of a participant share with who makes it. Safe from several threads.
#pragma once

#include <atomic>
#include <memory>

#include "services/bus/refused_packets.hpp"

namespace dyncal::bus {

struct TransportState {
  TransportState(std::shared_ptr<RefusedPackets> counter, int packet)
      : refused(std::move(counter)), packet_bytes(packet) {}

  std::shared_ptr<RefusedPackets> refused; // counts what is dropped
  int packet_bytes;                        // no packet that is sent is longer
  std::atomic<bool> listens{false};        // set when the participant is there
};

} // namespace dyncal::bus
