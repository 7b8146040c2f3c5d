// Whether a datagram may be handed to a vendor's library: its numbers go on from what came before,
// and participants announce themselves (plausible_numbers.hpp, participant_announcements.hpp).
//
// It protects a laboratory from copies of its own packets that were changed on the way or by
// someone: what another program at the ports of DDS sends is no such copy, and libraries pass over
// it. It is no protection against somebody who imitates a participant with care; that takes
// DDS Security. Anything that is not RTPS as it should be is let through, for the library or
// another screen to refuse. What participants had that are gone is forgotten, so that memory stays
// when they come and go. DDSI-RTPS 2.2, chapter 8.3. Any thread: the sockets of a participant share
// one object.
#pragma once

#include <atomic>
#include <chrono>

#include "services/bus/fastdds/screen/participant_announcements.hpp"
#include "services/bus/fastdds/screen/plausible_numbers.hpp"

namespace dyncal::bus {

class MessageCheck {
public:
  using Instant = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds forget_interval{30};

  [[nodiscard]] bool accepts(rtps_format::Bytes datagram,
                             Instant now = std::chrono::steady_clock::now());
  // Numbers that are held against each other.
  [[nodiscard]] std::size_t known_numbers() const { return numbers_.known(); }

private:
  void forget_the_gone(Instant now);

  std::atomic<Instant::rep> next_forgetting_{0}; // of the steady clock
  PlausibleNumbers numbers_;
  ParticipantAnnouncements announcements_;
};

} // namespace dyncal::bus
