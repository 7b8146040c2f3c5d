// Whether a participant announces itself, and as it did before.
//
// A library believes an announcement (DDSI-RTPS 8.5.3) regardless of who sent it: one changed byte
// gives a participant a lease of 0 s, with which it and all it writes are gone, or an address at
// which nobody is. So the GUID in it is that of the message's sender, and where it can be reached,
// for how long it is alive and what it consists of stay as they were. A change counts when it has
// come `sure_after` times in a row without the old announcement between. The GUID of a writer or
// reader that is announced (8.5.4) has the prefix of the message's sender, too.
//
// A participant leaves once, and says so (9.6.3.4): an announcement whose flags were changed is
// none of that. Of copies of goodbyes only the first is let through; anyone who is there again
// after one that was wrong is missed at the end of the lease.
//
// An announcement without a GUID is refused: Fast DDS 2.9 ends on an assertion (PDP.cpp) when the
// lease of a participant without one is over.
//
// A writer or reader is announced once, and seldom changes. A copy of its announcement with another
// number would take the place of the announcement that gets this number, and that writer or reader
// would never be known. So a second number for one counts when it has come `sure_after` times in a
// row, as anyone who misses it asks for it.
//
// Fields that are not known here may change. What is no list of parameters is refused.
// Bound: max_participants and max_endpoints; when there are more, all are forgotten. Anyone who has
// not announced itself for silence_limit is gone, and forgotten with what it had. Any thread.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {

class ParticipantAnnouncements {
public:
  using Instant = std::chrono::steady_clock::time_point;

  static constexpr int sure_after = 3;
  static constexpr std::chrono::seconds silence_limit{60}; // announcements come every second
  static constexpr std::size_t max_participants = 4096;
  static constexpr std::size_t max_endpoints = 16'384;

  // Of a DATA submessage, whatever it is about.
  [[nodiscard]] bool accepts(const rtps_format::Prefix& from, unsigned char flags,
                             rtps_format::Bytes body, Instant now);
  // Returns who is gone.
  std::set<rtps_format::Prefix> forget_the_gone(Instant now);

private:
  // What somebody stays with until another value has come often enough.
  template <class Value>
  struct Lasting {
    Value value{};
    Value changed{}; // as it came last
    int changed_in_a_row = 0;

    bool accepts(const Value& announced);
  };
  struct Known {
    Lasting<std::string> fields;
    Instant heard{};
    bool has_left = false;
  };
  using EndpointGuid = std::array<unsigned char, rtps_format::prefix_bytes + 4>;

  bool accepts_endpoint(rtps_format::Bytes guid, std::int64_t number);
  bool accepts_goodbye(const rtps_format::Prefix& from);
  bool accepts_announcement(const rtps_format::Prefix& from, const std::string& announced,
                            Instant now);

  std::mutex mutex_;
  std::map<rtps_format::Prefix, Known> known_;
  std::map<EndpointGuid, Lasting<std::int64_t>> endpoints_; // numbers of their announcements
};

// Whether a participant announces itself, or leaves, in this datagram.
[[nodiscard]] bool announces_participant(rtps_format::Bytes datagram);

} // namespace dyncal::bus
