// A number of the wire that its sender only lets grow, by small steps: of samples, or of
// heartbeats.
//
// What was sent before comes again (a repair, a late packet, the copy of a packet) and is let
// through: libraries tell it by its number. A number that is further ahead than `max_step` is not
// plausible. It becomes so when `sure_after` such numbers in a row have gone on from one another
// and none has gone on from the known ones: then the packets between were lost, for a link was down
// or nobody here listened. Numbers that come again tell neither way.
//
// A late joiner has no reference; its first number may be corrupt. So numbers are only held against
// each other once two have agreed. Belongs to one thread.
#pragma once

#include <cstdint>

namespace dyncal::bus {

class GrowingNumber {
public:
  enum class Kind { newer, known, implausible };

  static constexpr int sure_after = 6;
  static constexpr std::int64_t max_step_of_doubtful = 65'536;

  Kind judge(std::int64_t number, std::int64_t max_step);
  // Without taking notice of it.
  [[nodiscard]] bool is_plausible(std::int64_t number, std::int64_t max_step) const {
    return !agreed_ || number - newest_ <= max_step;
  }
  // Two have agreed.
  [[nodiscard]] bool agreed() const { return agreed_; }

private:
  std::int64_t newest_ = -1;
  bool agreed_ = false;
  std::int64_t doubtful_ = 0; // the last one that was too far ahead
  int doubtful_in_a_row_ = 0;
};

} // namespace dyncal::bus
