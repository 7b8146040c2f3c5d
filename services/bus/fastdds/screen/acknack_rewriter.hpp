// Rewrites the ACKNACKs that come from the network so that Fast DDS, of either version, takes
// notice of readers that start over: the ACKNACK by which one does becomes one for sample 0,
// without a list and with a new count, and the counts of later ones go on from there
// (acknack_counts.hpp).
//
// DDSI-RTPS 2.2, 8.3.7.1. One thread at a time.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "services/bus/fastdds/screen/acknack_counts.hpp"
#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {

class AcknackRewriter {
public:
  static constexpr std::size_t max_body_bytes = rtps_format::entities_bytes +
                                                rtps_format::sequence_bytes + 4 +
                                                rtps_format::max_bits_of_set / 8 + 4;

  // In place. `source` is the prefix of the reader's participant. Returns the length of the body to
  // hand on, which is not longer; nothing where it is not an ACKNACK as it should be.
  [[nodiscard]] std::optional<std::size_t> rewrite(rtps_format::Bytes source, unsigned char& flags,
                                                   std::span<unsigned char> body);
  // All of a message, whose length stays: a body that became shorter has bytes behind it that say
  // nothing. What is not as it should be is left as it is.
  void rewrite_all(std::span<unsigned char> datagram);

private:
  AcknackCounts counts_;
};

} // namespace dyncal::bus
