// Does a series belong to the trigger that has just been seen? The sensor counts its triggers
// (`shot` of a series, 0: it does not).
//
// Since the series that was accepted last, so many triggers came for sure (traces that were read)
// and so many may have come (shots of which the trace was lost). A series whose number says that it
// belongs to one of the earlier triggers is late: the right one is still to come. A number that
// fits no count, or more than one, leaves it open; then the shot is given up, and counting begins
// anew with it. One thread.
#pragma once

#include <cstdint>
#include <optional>

namespace dyncal::services::dso {

enum class SeriesVerdict { belongs, late, open };

class TriggerCount {
public:
  void trigger_came() { ++certain_; }
  void trigger_may_have_come() { ++possible_; }

  [[nodiscard]] SeriesVerdict judge(std::uint64_t shot) {
    const bool nothing_known = !last_ || *last_ == 0 || shot == 0;
    const std::uint64_t least = nothing_known ? shot : *last_ + certain_;
    if (!nothing_known && shot > *last_ && shot < least) {
      return SeriesVerdict::late;
    }
    const bool fits = nothing_known || shot == least + possible_;
    last_ = shot;
    certain_ = 0;
    possible_ = 0;
    return fits ? SeriesVerdict::belongs : SeriesVerdict::open;
  }

  [[nodiscard]] std::optional<std::uint64_t> last() const { return last_; }

private:
  std::optional<std::uint64_t> last_; // number of the series that was judged last and was not late
  std::uint64_t certain_ = 0;
  std::uint64_t possible_ = 0;
};

} // namespace dyncal::services::dso
