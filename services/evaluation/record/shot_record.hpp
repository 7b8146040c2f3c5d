// The triggered records of a run: traces of the oscilloscope and series of the sensor, paired by
// session and shot number.
//
// A record carries the step of the run that it belongs to, and which excitation of it. One whose
// sizes contradict each other, or that holds a value that is not finite, is not used; beyond
// `capacity` records of a kind new ones are dropped. Both are counted for their step. Belongs to
// one thread.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "services/contract/triggered_record.hpp"

namespace dyncal::inline evaluation {

struct StepAttempt {
  std::uint32_t step = 0; // as the recipe numbers it
  std::uint32_t attempt = 1;

  friend auto operator<=>(const StepAttempt&, const StepAttempt&) = default;
};

class ShotRecord {
public:
  static constexpr std::size_t capacity = 1024;

  struct Shot {
    const TriggeredRecord* trace;
    const TriggeredRecord* series;
  };
  struct Loss { // that came and could not be kept
    std::uint64_t records = 0;
    std::uint64_t unusable_samples = 0; // in them, as they tell themselves
    std::uint64_t overflowed_samples = 0;
  };
  struct Losses {
    Loss traces{};
    Loss series{};
  };

  void add_trace(TriggeredRecord record);
  void add_series(TriggeredRecord record);

  // Those of which both records are there, in the order of their numbers. Valid until the next call
  // that changes something.
  [[nodiscard]] std::vector<Shot> of_step(StepAttempt step) const;
  [[nodiscard]] Losses lost_in(StepAttempt step) const;
  void forget_step(StepAttempt step);

private:
  using Key = std::pair<std::uint64_t, std::uint64_t>; // session, shot
  using Records = std::map<Key, TriggeredRecord>;
  static void add(Records& records, TriggeredRecord record, Loss& loss);

  Records traces_;
  Records series_;
  std::map<StepAttempt, Losses> lost_;
};

} // namespace dyncal::inline evaluation
