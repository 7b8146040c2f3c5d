#include "drivers/can/time/wrapping_counter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dyncal::drivers::can {

namespace {

constexpr double max_late = 64.0;           // steps; queues on the way hold no more of one sensor
constexpr double max_late_s = 0.1;          // of a counter of time
constexpr std::uint64_t max_late_part = 16; // of the range, where no rate tells late from lost
constexpr unsigned late_of_a_restart = 8;   // in a row

} // namespace

std::uint64_t WrappingCounter::late_by(std::uint64_t raw, double expected, double step) const {
  const std::uint64_t behind = (last_->raw - raw) & mask();
  const std::uint64_t part = rate_hz_ > 0.0 ? 2 : max_late_part;
  const double late = -static_cast<double>(behind);
  if (behind == 0 || behind > mask() / part + 1 ||
      -late > std::max(max_late, max_late_s * rate_hz_)) {
    return 0;
  }
  return rate_hz_ <= 0.0 || std::abs(late - expected) < std::abs(step - expected) ? behind : 0;
}

WrappingCounter::Reading WrappingCounter::read(std::uint64_t raw, std::int64_t time_ns) {
  if (!last_) {
    last_ = Last{raw, time_ns, 0};
    return {Step::first, 0};
  }
  const std::uint64_t modular = (raw - last_->raw) & mask();
  const double expected = static_cast<double>(time_ns - last_->time_ns) * 1e-9 * rate_hz_;
  double step = static_cast<double>(modular);
  if (rate_hz_ > 0.0) {
    const double range = std::ldexp(1.0, static_cast<int>(bits_));
    step += range * std::max(0.0, std::round((expected - step) / range));
  }
  if (const std::uint64_t behind = late_by(raw, expected, step);
      behind > 0 && ++late_in_a_row_ < late_of_a_restart) {
    return {Step::late, last_->value - static_cast<std::int64_t>(behind)};
  }
  const bool is_late_again = std::exchange(late_in_a_row_, 0U) >= late_of_a_restart;
  if (is_late_again) {
    last_ = Last{raw, time_ns, last_->value + 1};
    return {Step::restarted, last_->value};
  }
  if (rate_hz_ > 0.0) {
    // Queues on the way make the time wrong by some steps, never by half a second's worth, and the
    // rate by a few percent at most.
    const double tolerated = std::max({4.0, 0.5 * rate_hz_, 0.1 * expected});
    if (step - expected > tolerated) {
      last_ = Last{raw, time_ns, last_->value + 1};
      return {Step::restarted, last_->value};
    }
  }
  if (step == 0.0) {
    return {Step::repeated, last_->value};
  }
  last_ = Last{raw, time_ns, last_->value + static_cast<std::int64_t>(step)};
  return {Step::forward, last_->value};
}

} // namespace dyncal::drivers::can
