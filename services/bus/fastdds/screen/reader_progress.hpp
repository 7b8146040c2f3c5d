// How far the readers of this participant are with each writer, by the ACKNACKs that they send, and
// how far one packet may move them on.
//
// Fast DDS visits every number of a GAP, and those up to the beginning of a HEARTBEAT, one by one
// and with the reader locked; what a GAP names beyond the first number that a reader lacks it keeps
// one by one, too. So one packet with a copied GUID stops a program for minutes, or takes gigabytes
// (CVE-2025-64438). Ranges of millions are genuine as well: a writer that keeps one message a key
// has long holes, and a late joiner is told of all that it has missed. So nothing is refused for
// its length, but handed on in pieces:
//
//   GAP        from where the reader is, if it begins there: as far as the allowance goes; its
//              rest is told again, since the reader asks for it, once for each of its ACKNACKs.
//              Beyond `window` from there: left out, a reader asks for 256 numbers at a time. The
//              same where it is not known where the reader is
//   HEARTBEAT  its beginning is at most the allowance ahead of the reader, which then asks for
//              what is not there any more, and is told that it is not
//
// The allowance is in visits of 0.12 us, of which a number of a GAP takes three (measured, version
// 2.9). It grows by visits_per_s to max_visits and is shared by all readers; `window` numbers go on
// regardless. So a program stands for at most 0.07 s at a time, and for a quarter of the time while
// somebody does what he can; and 10^7 numbers that are gone hold a late joiner up for 5 s in a
// heartbeat, 14 s in a GAP.
//
// A piece that Fast DDS passes over, for it does not know the writer yet, is told again once a
// reader sends an ACKNACK. Bound: max_readers, of which all are forgotten when there are more. Any
// thread: the sockets of a participant share one object.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <tuple>

#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {

class ReaderProgress {
public:
  using Instant = std::chrono::steady_clock::time_point;

  static constexpr std::int64_t window = 1024;
  static constexpr std::int64_t max_visits = 1 << 19;
  static constexpr std::int64_t visits_per_s = 1 << 21;
  static constexpr std::int64_t visits_in_gap = 3; // of each number
  static constexpr std::chrono::seconds lives{3};  // in GAPs to all readers of a writer
  static constexpr std::size_t max_readers = 16'384;

  struct Range {
    std::int64_t first = 0;
    std::int64_t end = 0; // behind the last
  };

  // A datagram of this participant.
  void sent(rtps_format::Bytes datagram, Instant now = std::chrono::steady_clock::now());
  // What to hand on of a GAP by a writer of the participant `source`; nothing if end <= first.
  // `entities` are the ids of reader (0: all) and writer.
  [[nodiscard]] Range of_gap(rtps_format::Bytes source, rtps_format::Bytes entities, Range range,
                             Instant now = std::chrono::steady_clock::now());
  // The number that a HEARTBEAT that begins with `first` is to begin with.
  [[nodiscard]] std::int64_t heartbeat_begin(rtps_format::Bytes source, rtps_format::Bytes entities,
                                             std::int64_t first,
                                             Instant now = std::chrono::steady_clock::now());

private:
  using EntityId = std::array<unsigned char, rtps_format::entity_bytes>;
  struct Key {
    rtps_format::Prefix participant{}; // of the writer
    EntityId writer{};
    EntityId reader{};
    friend bool operator<(const Key& left, const Key& right) {
      return std::tie(left.participant, left.writer, left.reader) <
             std::tie(right.participant, right.writer, right.reader);
    }
  };
  struct Progress {
    std::int64_t next = 1; // the first number that it lacks
    Instant told;
    bool moved = false; // by a piece, since then
  };
  using AllProgress = std::map<Key, Progress>;

  static Key key_of(rtps_format::Bytes source, rtps_format::Bytes entities);
  // Of the reader, or that reader of the writer which `is_better`; nothing if none is known.
  template <class IsBetter>
  AllProgress::iterator find(const Key& key, IsBetter is_better);
  void acknowledged(const Key& key, std::int64_t next, Instant now);
  // Numbers of `wanted` that may be visited so often each.
  std::int64_t allowed(std::int64_t wanted, std::int64_t visits, Instant now);

  std::mutex mutex_;
  AllProgress readers_;
  std::int64_t allowance_ = max_visits;
  Instant granted_;
};

} // namespace dyncal::bus
