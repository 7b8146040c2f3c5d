// Does a series belong to the trigger that has just been seen? The sensor counts its triggers
// (`shot` of a series, 0: it does not).
//
// Since the series that was accepted last, so many triggers came for sure (traces that were read)
// and so many may have come (shots of which the trace was lost). A series whose number says that it
// belongs to one of the earlier triggers is late: the right one is still to come. A number that
// fits no count, or more than one, leaves it open; then the shot is given up, and counting begins
// again with it.
//
// The first series of all belongs to nothing that is known: an edge before the oscilloscope was
// armed may have triggered the sensor, which then did not take the trigger that was seen. It only
// tells the sensor's count and is left out; so is the first one after the sensor began or ceased to
// count. The later ones of a sensor that does not count are believed. One thread.
#pragma once

#include <cstdint>
#include <optional>

namespace dyncal::inline instruments {

enum class SeriesVerdict { belongs, late, open, first };

class TriggerCount {
public:
  void trigger_came() { ++certain_; }
  void trigger_may_have_come() { ++possible_; }

  [[nodiscard]] SeriesVerdict judge(std::uint64_t shot) {
    const SeriesVerdict verdict = compare(shot);
    if (verdict != SeriesVerdict::late) {
      last_ = shot;
      certain_ = 0;
      possible_ = 0;
    }
    return verdict;
  }

  [[nodiscard]] std::optional<std::uint64_t> last() const { return last_; }

private:
  [[nodiscard]] SeriesVerdict compare(std::uint64_t shot) const {
    const bool counts = shot != 0;
    if (!last_ || (*last_ != 0) != counts) {
      return SeriesVerdict::first;
    }
    if (!counts) {
      return SeriesVerdict::belongs;
    }
    const std::uint64_t least = *last_ + certain_;
    if (shot > *last_ && shot < least) {
      return SeriesVerdict::late;
    }
    return shot == least + possible_ ? SeriesVerdict::belongs : SeriesVerdict::open;
  }

  std::optional<std::uint64_t> last_; // number of the series that was judged last and was not late
  std::uint64_t certain_ = 0;
  std::uint64_t possible_ = 0;
};

} // namespace dyncal::inline instruments
