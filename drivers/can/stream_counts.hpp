// What a stream of one sensor on CAN counts, and the same in the words that all drivers share.
// Counts run from the start of the stream. Plain data.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/sample_counts.hpp"

namespace dyncal::drivers::can {

struct StreamCounts {
  std::uint64_t frames = 0;         // of the sensor's messages
  std::uint64_t samples = 0;        // handed on
  std::uint64_t lost = 0;           // samples that are missing by the numbers
  std::uint64_t dropped_frames = 0; // by the socket
  std::uint64_t incomplete = 0;     // samples of which a frame did not come
  std::uint64_t repeated = 0;       // frames that came twice
  std::uint64_t late = 0;           // samples that came behind later ones, and are left out
  // Frames too short for their counter or of an unknown rate, samples without SYNC.
  std::uint64_t rejected = 0;
  std::uint64_t short_frames = 0;              // frames that lack a signal; its value is NaN
  std::uint64_t no_value = 0;                  // J1939 "not available" and "error"
  std::uint64_t not_trusted = 0;               // samples handed on with a flag
  std::uint64_t interruptions = 0;             // of the link
  std::uint64_t restarts = 0;                  // of the sensor's numbering
  std::uint64_t clock_restarts = 0;            // of a line between clocks
  std::map<std::string, std::uint64_t> faults; // error frames by cause
};

// `link` adds the counts of the controller, `u_clock_s` is the standard uncertainty of a stamp now.
[[nodiscard]] SampleCounts sample_counts(const StreamCounts& stream, const LinkState& link,
                                         double u_clock_s);

} // namespace dyncal::drivers::can
