// How many packets each network interface of this host was given to send, and how many of them its
// queue had no room for: what an overloaded link shows on the host that overloads it. Packets that
// switches, or other hosts, drop are not seen here.
//
// The counters of the root queueing discipline, as `tc -s qdisc` shows them, over rtnetlink(7).
// Empty where the kernel does not tell them. Any thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace dyncal::inline checks::doctor {

struct SendQueue { // since it was set up
  std::uint64_t sent = 0;
  std::uint64_t dropped = 0;
};

// By the names of the interfaces.
[[nodiscard]] std::map<std::string, SendQueue> send_queues();

} // namespace dyncal::inline checks::doctor
