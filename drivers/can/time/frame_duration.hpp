// How long a frame was on the bus, exactly.
//
// From the start-of-frame bit to the end of the end-of-frame field, in bits, stuff bits counted
// from the frame's own bits and checksum (ISO 11898-1:2015; classic CRC-15; CAN FD with fixed stuff
// bits around its checksum).
//
// A CAN FD frame with bit rate switch changes its rate at the sample points of BRS and of the CRC
// delimiter. The two parts of the switched bits add up to one nominal and one data bit whatever the
// sample points are, so the duration does not depend on them. Not contained: the intermission, and
// what transmitter delay adds to ACK. Pure functions; any thread.
#pragma once

#include <cstdint>

#include "drivers/can/bus/bit_rates.hpp"
#include "drivers/can/bus/can_frame.hpp"

namespace dyncal::drivers::can {

struct FrameBits {
  unsigned nominal = 0; // at the nominal rate
  unsigned data = 0;    // at the data rate
  unsigned stuff = 0;   // of both: bits that stuffing has inserted
};

[[nodiscard]] FrameBits frame_bits(const CanFrame& frame);

// REQUIRES: nominal_per_s > 0; data_per_s > 0 when the frame switches rates.
[[nodiscard]] double frame_duration_s(const CanFrame& frame, const BitRates& rates);

// The longest that a frame of this format and length can be, whatever its id and content.
[[nodiscard]] double max_frame_s(bool fd, bool bit_rate_switch, unsigned length_bytes,
                                 const BitRates& rates);

} // namespace dyncal::drivers::can
