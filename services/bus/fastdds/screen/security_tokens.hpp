// Whether what participants say for DDS Security in the clear can be read to its end: the tokens of
// their announcements, and the messages of the handshake that comes before anybody is trusted.
//
// Fast DDS reads these in every participant, secured or not, and believes the lengths in them
// (CVE-2025-62599 to 62603: it reads beyond, or asks for all memory). DDS Security 1.1, 7.2.3 and
// 7.4.3. Plain functions, any thread.
#pragma once

#include <cstdint>

#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {

// Of a parameter in an announcement.
[[nodiscard]] bool is_security_token(std::uint16_t parameter);
// Its value, a DataHolder.
[[nodiscard]] bool token_is_whole(rtps_format::Bytes value, unsigned char flags);

// The payload of a ParticipantStatelessMessage.
[[nodiscard]] bool handshake_is_whole(rtps_format::Bytes payload);

} // namespace dyncal::bus
