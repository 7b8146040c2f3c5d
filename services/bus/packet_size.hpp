// How long packets may be: the payload of UDP that an implementation may send in one.
//
// One frame that is lost of a packet with several takes the whole packet, and the kernel keeps the
// rest of it for 30 s in a buffer of 4 MB, so that a lossy network soon carries nothing more.
// Packets therefore fit a frame:
//
//   mixed   of Ethernet, 1472 bytes, wherever they go: the most that Fast DDS with these settings
//           receives where nothing of dyncal screens it
//   same    of the network interfaces that are used, the smallest of them: 64 kB on one computer,
//           where a block is a packet
//
// A secured participant has packets of its own (decisions/25-secured-blocks.md). Any thread; asks
// the operating system each time.
#pragma once

#include "services/bus/bus.hpp"

namespace dyncal::bus {

// The most that UDP carries, as a multiple of four, as RTPS aligns its messages
// (participant_security.hpp).
inline constexpr int longest_payload_bytes = 65500;

// Of all interfaces that are up where `options` names none, but the loopback one only where there
// is no other.
[[nodiscard]] int packet_payload_bytes(const ParticipantOptions& options);

} // namespace dyncal::bus
