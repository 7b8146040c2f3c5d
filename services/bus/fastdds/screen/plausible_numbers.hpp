// Whether the sequence numbers and counts of a submessage go on from what its writer or reader has
// sent so far (growing_number.hpp).
//
// Libraries believe them, regardless of who sent the packet. A HEARTBEAT, GAP or ACKNACK that names
// samples far ahead makes a reader give up what it has not got yet, or a writer forget what was not
// received; a count far ahead makes them deaf to all that follow (DDSI-RTPS 8.4.15.7); DATA with a
// number to come takes the place of the sample that will have it. One changed byte of a real packet
// is enough.
//
//   DATA, DATA_FRAG  number      at most max_samples_ahead of the newest
//   GAP              its end     the same, however often: heartbeats tell how far a writer is
//   HEARTBEAT        its end     at most max_announced_ahead; its beginning not behind its end
//   ACKNACK          its base    at most max_acknowledged_ahead of the one before
//   count of HEARTBEAT, HEARTBEAT_FRAG, ACKNACK, NACK_FRAG  at most max_counts_ahead
//
// A number that no writer can have (rtps_format.hpp) is refused at any time: Cyclone DDS 0.10 takes
// a negative one for a very large one.
//
// What is refused for once is like a lost packet, and repaired like one. A submessage that is too
// short is none of this; others look at that.
//
// Bound: max_newcomers and max_known numbers; those of newcomers, of which no two have agreed yet,
// and of the known ones are forgotten all together when there are more. Any thread: the sockets of
// a participant share one object.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>
#include <unordered_map>

#include "services/bus/fastdds/screen/growing_number.hpp"
#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {

class PlausibleNumbers {
public:
  static constexpr std::int64_t max_samples_ahead = 4;
  static constexpr std::int64_t max_announced_ahead = 128;
  static constexpr std::int64_t max_acknowledged_ahead = 4096;
  static constexpr std::int64_t max_counts_ahead = 64;
  static constexpr std::size_t max_newcomers = 4096;
  static constexpr std::size_t max_known = 16'384;

  // Participants between which a submessage goes.
  struct Way {
    rtps_format::Prefix from{};
    rtps_format::Prefix to{}; // 0: any
  };

  [[nodiscard]] bool accepts(const Way& way, unsigned char id, unsigned char flags,
                             rtps_format::Bytes body);
  // What these participants have sent, and what was sent to them.
  void forget(const std::set<rtps_format::Prefix>& participants);
  [[nodiscard]] std::size_t known() const;

private:
  enum class Numbered : unsigned char { samples, heartbeats, heartbeat_frags, acks, base, nacks };
  using Key = std::array<unsigned char, 2 * rtps_format::prefix_bytes + 8 + 1>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  using Numbers = std::unordered_map<Key, GrowingNumber, KeyHash>;

  static Key of_writer(const Way& way, rtps_format::Bytes writer, Numbered numbered);
  static Key of_reader(const Way& way, rtps_format::Bytes entities, Numbered numbered);
  GrowingNumber::Kind judge(const Key& key, std::int64_t number, std::int64_t max_step);
  [[nodiscard]] bool is_plausible(const Key& key, std::int64_t number, std::int64_t max_step) const;
  bool accepts_sample(const Way& way, unsigned char flags, rtps_format::Bytes body);
  bool accepts_gap(const Way& way, unsigned char flags, rtps_format::Bytes body);
  bool accepts_heartbeat(const Way& way, unsigned char flags, rtps_format::Bytes body);
  bool accepts_heartbeat_frag(const Way& way, unsigned char flags, rtps_format::Bytes body);
  bool accepts_acknack(const Way& way, unsigned char flags, rtps_format::Bytes body);
  bool accepts_nack_frag(const Way& way, unsigned char flags, rtps_format::Bytes body);

  mutable std::mutex mutex_;
  Numbers newcomers_;
  Numbers known_;
};

} // namespace dyncal::bus
