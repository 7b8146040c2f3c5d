// What a receiver of SmartUp Units counts, of one sensor and of one address, and the same in the
// words that all drivers share.
//
// Every sample number of a sensor that was passed is received, lost or rejected. Counts run from
// the start of the receiver. Plain data.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/sample_counts.hpp"
#include "drivers/smartup/datagram.hpp"
#include "drivers/smartup/stamp_check.hpp"

namespace dyncal::drivers::smartup {

struct SensorCounts {
  std::uint64_t received = 0;
  std::uint64_t lost_in_unit = 0;
  std::uint64_t lost_on_way = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t late = 0;         // came after its place had been counted as lost; it stays lost
  std::uint64_t stale = 0;        // kept by the unit from before a pause or restart, not handed on
  std::uint64_t restarts = 0;     // of the numbering
  std::uint64_t other_sender = 0; // same id from a second sender, not handed on
  std::uint64_t new_columns = 0;  // channels appeared that had not been there
  std::uint64_t without_sync = 0; // samples whose partner of the sync sensor never came
  std::array<std::uint64_t, rejections> rejected{};
  std::array<std::uint64_t, stamp_flag_count> stamp_flags{};
  std::uint64_t stamps_not_trusted = 0; // samples with at least one flag
  // Standard uncertainty of the newest stamp in the unit's clock; 0: the unit does not know it.
  std::uint32_t stamp_uncertainty_ns = 0;
};

// Of one address that is listened to.
struct ReceptionCounts {
  std::uint64_t datagrams = 0;
  std::uint64_t dropped_by_kernel = 0; // datagrams: the receive buffer was full
  std::uint64_t found_lost = 0; // datagrams that never came, as far as whole ones can be told
  std::uint64_t too_long = 0;   // datagrams longer than any of a unit
  std::uint64_t refused = 0;    // datagrams or messages of units or sensors beyond the limits
  std::array<std::uint64_t, rejections> rejected{}; // datagrams, and messages of no known sensor
};

// Causes that concern the whole address (datagrams, not samples) are among those of every sensor
// received there.
[[nodiscard]] SampleCounts sample_counts(const SensorCounts& sensor,
                                         const ReceptionCounts& reception);

} // namespace dyncal::drivers::smartup
