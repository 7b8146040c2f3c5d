// Whether a datagram may be handed to a vendor's library: its numbers go on from what came before,
// and participants announce themselves (plausible_numbers.hpp, participant_announcements.hpp).
//
// It protects a laboratory from copies of its own packets that were changed on the way or by
// someone: what another program at the ports of DDS sends is no such copy, and libraries pass over
// it. It is no protection against somebody who imitates a participant with care; that takes
// DDS Security. Anything that is not RTPS as it should be is let through, for the library or
// another screen to refuse. DDSI-RTPS 2.2, chapter 8.3. Any thread: the sockets of a participant
// share one object.
#pragma once

#include "services/bus/rtps/participant_announcements.hpp"
#include "services/bus/rtps/plausible_numbers.hpp"

namespace dyncal::bus {

class MessageCheck {
public:
  [[nodiscard]] bool accepts(rtps_format::Bytes datagram);

private:
  PlausibleNumbers numbers_;
  ParticipantAnnouncements announcements_;
};

} // namespace dyncal::bus
