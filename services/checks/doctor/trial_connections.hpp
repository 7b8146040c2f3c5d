// Whether packets get from this host to another one and back, where no program there answers: TCP
// connections that the other kernel accepts or refuses by itself. So it needs no program there, no
// right here, and tells a link that loses or delays most of them from a way that is cut.
//
// A connection is begun every 25 ms to each host, at a port at which nobody listens, 40 at most.
// An answer within half a second is in time; the kernel sends again what has none after 1 s, so
// that a later answer means that a packet was lost, or waited in queues. It is waited for until
// everything is answered, at most for 3.2 s, in which each was sent three times. Blocks; any
// thread.
#pragma once

#include <map>
#include <set>
#include <stop_token>
#include <string>

namespace dyncal::inline checks::doctor {

inline constexpr int discard_port = 9; // RFC 863; whoever listens there takes a connection, too

struct TriedHost { // connections
  unsigned begun = 0;
  unsigned in_time = 0;
  unsigned late = 0;         // answered, but not in time
  bool has_no_route = false; // this host does not know by which interface it is reached
  std::string own_address{}; // by which this host reaches it

  // 0 to 1; how much of what was begun was not answered in time.
  [[nodiscard]] double missed_part() const {
    return begun == 0 ? 0.0 : 1.0 - static_cast<double>(in_time) / static_cast<double>(begun);
  }
};

// By the IPv4 addresses; of more than four of them only the first.
[[nodiscard]] std::map<std::string, TriedHost> try_hosts(const std::set<std::string>& addresses,
                                                         const std::stop_token& stop,
                                                         int port = discard_port);

} // namespace dyncal::inline checks::doctor
