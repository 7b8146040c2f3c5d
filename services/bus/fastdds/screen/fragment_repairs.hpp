// Keeps a writer from repairing a fragment over and over while the first repair is on its way.
//
// A reader in Fast DDS or Cyclone DDS asks for what it lacks after each heartbeat. Where a packet
// is on its way for longer than the time between two heartbeats, as on a link of 10 Mbit/s with a
// queue before it, every request comes several times, and Fast DDS 2.9 answers each (its
// suppression of NACKs does not know fragments): the repairs fill the link and keep the queue long.
// Here a fragment that went to a reader within min_interval does not go there again, and each
// repair doubles the interval up to max_interval, for the way may take longer than that. The reader
// asks again. What went to nobody in particular went to all readers at its destination; a repair
// names its reader (submessage INFO_DST and the reader's entity), and another reader there, perhaps
// of a program that has just begun, does not wait for it.
//
// Bound: what was sent within max_interval, at most max_fragments; what is older or over it is
// forgotten and sent. One thread at a time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <unordered_map>
#include <utility>

namespace dyncal::bus {

class FragmentRepairs {
public:
  using Instant = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::milliseconds min_interval{20};
  static constexpr std::chrono::milliseconds max_interval{1280};
  static constexpr std::size_t max_fragments = 32'768;

  // Whether all that `datagram` carries are fragments that went to `destination` lately; otherwise
  // they go now.
  [[nodiscard]] bool went_lately(std::span<const unsigned char> datagram, std::size_t destination,
                                 Instant now);

private:
  struct Fragment {
    std::size_t to_reader; // hashes of what names it
    std::size_t to_all;    // the same of a fragment for all readers
  };
  struct Sent {
    Instant at;
    std::chrono::milliseconds interval; // until it may go again
  };

  [[nodiscard]] bool went_lately(const Fragment& fragment, Instant now) const;
  void note(const Fragment& fragment, Instant now);
  void forget(Instant now);

  std::unordered_map<std::size_t, Sent> sent_; // by reader, writer, sample, fragment, destination
  std::deque<std::pair<std::size_t, Instant>> in_order_;
};

} // namespace dyncal::bus
