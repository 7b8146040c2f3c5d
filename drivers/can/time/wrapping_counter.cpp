#include "drivers/can/time/wrapping_counter.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::can {

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

std::optional<std::int64_t> WrappingCounter::near_last(std::uint64_t raw) const {
  if (!last_) {
    return std::nullopt;
  }
  const std::uint64_t ahead = (raw - last_->raw) & mask();
  const std::uint64_t half = std::uint64_t{1} << (bits_ - 1);
  return ahead < half ? last_->value + static_cast<std::int64_t>(ahead)
                      : last_->value - static_cast<std::int64_t>((last_->raw - raw) & mask());
}

} // namespace dyncal::drivers::can
