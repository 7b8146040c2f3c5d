// The triggered records of a run: traces of the oscilloscope and series of the sensor, paired by
// session and shot number.
//
// A record says to which step of the run it belongs. One whose sizes contradict each other is
// counted and not used. Bounded: beyond `capacity` records of a kind new ones are dropped and
// counted. Belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "idl/dyncal.h"

namespace dyncal::services {

class ShotRecord {
public:
  static constexpr std::size_t capacity = 1024;

  struct Shot {
    const wire::TriggeredRecord* trace;
    const wire::TriggeredRecord* series;
  };

  void add_trace(const wire::TriggeredRecord& record) { add(traces_, record); }
  void add_series(const wire::TriggeredRecord& record) { add(series_, record); }

  // Those of which both records are there, in the order of their numbers. Valid until the next call
  // that changes something.
  [[nodiscard]] std::vector<Shot> of_step(std::uint32_t step) const;
  void forget_step(std::uint32_t step);

  [[nodiscard]] std::uint64_t unusable() const { return unusable_; }
  [[nodiscard]] std::uint64_t overflowed() const { return overflowed_; }

private:
  using Key = std::pair<std::uint64_t, std::uint64_t>; // session, shot
  using Records = std::map<Key, wire::TriggeredRecord>;
  void add(Records& records, const wire::TriggeredRecord& record);

  Records traces_;
  Records series_;
  std::uint64_t unusable_ = 0;
  std::uint64_t overflowed_ = 0;
};

// Values of one channel.
[[nodiscard]] std::span<const double> channel_of(const wire::TriggeredRecord& record,
                                                 std::size_t channel);

} // namespace dyncal::services
