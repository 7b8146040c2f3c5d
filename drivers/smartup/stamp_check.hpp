// Recognises the time stamps of a SmartUp Unit that cannot be true, by the signatures that its
// firmware's faults leave, and says so in StampFlag bits. The stamps themselves are never changed.
//
// Model: true stamps lie on t(n) = t0 + n T with a period that drifts slowly; t0 and T follow the
// trusted stamps with a second-order loop (gains phase_gain, period_gain), so that a single early
// or late sample hardly moves them. The difference r = stamp - t(n) is honest jitter while |r|
// stays below a tolerance: a quarter of a period up to 200 us, or ten times the usual |r| of this
// sensor if that is more, but never more than half a period. Beyond it:
//   r = +-k s                          second_slip          second mislabelled
//   r = +-2^32 ticks (39.768 s)        counter_extension    32-bit extension of the counter
//   r = +-2^16 ticks (606.8 us)        torn_counter         halves of the counter read at different
//   times |r| < 1 s otherwise                offset_below_second  e.g. an extra PPS edge stamp
//   earlier than the one before  backwards
// and, without any model: the stamp of the sample before (repeated), uncertainty 0
// (no_uncertainty), unix time 0 (no_fix). Ticks are those of 108 MHz, or 100 MHz of the units of
// 2018. While stamps are wrong the model runs free. A change that lasts (10 s and 8 samples) is
// taken as the truth from then on. A jump forward of more than a second with no signature is a
// pause of the unit, one of up to 1000 whole periods, within ten times the usual |r| or T/1000, is
// of samples that the numbers do not show to be lost: only the first sample is flagged
// (offset_below_second), if the next one follows from it.
// The first 8 stamps only found the model (median period): they get the flags that need none.
// One sensor, one numbering, one thread. Cost: some ten nanoseconds a sample.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::smartup {

struct Stamp {
  std::uint64_t sample = 0; // unwrapped; ahead of the sample before
  std::int64_t stamp_ns = 0;
  std::uint32_t time_uncertainty_ns = 0;
  bool no_fix = false; // unix time 0
};

inline constexpr std::size_t stamp_flag_count = 8;
// Of one flag, for counts and messages.
[[nodiscard]] const char* to_string(StampFlag flag);

class StampCheck {
public:
  // StampFlag bits of this stamp; 0: trusted.
  [[nodiscard]] std::uint8_t check(const Stamp& stamp);

  // 0 as long as it is not known.
  [[nodiscard]] double period_ns() const { return founded_ ? period_ns_ : 0.0; }

private:
  static constexpr std::size_t founder_count = 8;

  void found(const Stamp& stamp);
  [[nodiscard]] double residual_ns(const Stamp& stamp) const;
  [[nodiscard]] double tolerance_ns(const Stamp& stamp) const;
  [[nodiscard]] std::uint8_t signature(double residual_ns, double tolerance_ns,
                                       const Stamp& stamp) const;
  [[nodiscard]] bool is_of_lost_samples(double residual_ns) const;
  [[nodiscard]] bool follows_from_last(const Stamp& stamp, double tolerance_ns) const;
  [[nodiscard]] bool lasts(const Stamp& stamp);
  void follow(const Stamp& stamp, double residual_ns);
  std::uint8_t check_against_model(const Stamp& stamp);

  std::array<Stamp, founder_count> founders_{};
  std::size_t founder_count_ = 0;
  bool founded_ = false;

  Stamp
      origin_; // the model: t(n) = origin_.stamp_ns + phase_ns_ + (n - origin_.sample) * period_ns_
  double phase_ns_ = 0.0; // below one nanosecond after each step
  double period_ns_ = 0.0;
  double usual_residual_ns_ = 0.0;
  std::uint64_t distrusted_in_a_row_ = 0;

  // Of the stamp before. In this order, and not as a Stamp: to copy one that was just put together
  // as a whole waits until all stores before it are in the cache, which was a twelfth of all that
  // dyncal-dau does for a sample.
  std::uint64_t last_sample_ = 0;
  bool has_last_ = false;
  bool last_no_fix_ = false;
  bool last_was_jump_ = false; // forward, by a pause or by lost samples
  std::int64_t last_stamp_ns_ = 0;
};

} // namespace dyncal::drivers::smartup
