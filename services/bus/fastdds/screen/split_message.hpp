// A message of several submessages as several of one packet each.
//
// A secured participant in Fast DDS may send messages of 64 kB, so that none of its samples is cut
// into fragments. It fills such a message with all samples that it has to send, and one lost packet
// costs them all. Each part has the header and what counts for the submessages behind it
// (INFO_DST, INFO_TS, INFO_SRC). What is encrypted as one stays together (SEC_PREFIX to
// SEC_POSTFIX), and a submessage that is longer than a packet is a part of its own; a message that
// is encrypted as a whole comes back as it is.
//
// Fast DDS 2.9 ends each of its messages with a submessage for statistics, which its transport
// fills in as it sends: where the last one has to be, it writes 56 bytes if its first byte is that
// submessage's. So each part ends with it, too; without it the transport wrote into what was sent,
// once in 256 parts, and a handshake with such a reply never ended.
//
// DDSI-RTPS 2.2, chapter 8.3; DDS Security 1.1, chapter 7.3.6. Plain function, any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dyncal::bus {

// Parts of at most `wanted` bytes where submessages are short enough for it.
[[nodiscard]] std::vector<std::vector<unsigned char>>
split_message(std::span<const unsigned char> message, std::size_t wanted);

} // namespace dyncal::bus
