#include "drivers/can/sample_numbers.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::can {

std::uint64_t SampleNumbers::next(const SensorLayout& layout, std::int64_t key,
                                  std::int64_t kernel_ns) {
  std::uint64_t number = 0;
  lost_before_ = 0;
  if (last_) {
    const std::uint64_t step =
        layout.keys.empty() ? step_by_arrival(layout, kernel_ns) : step_by_key(layout, key);
    number = last_->number + step;
    lost_before_ = step - 1;
  }
  last_ = {number, key, kernel_ns};
  frames_dropped_ = 0;
  interrupted_ = false;
  return number;
}

std::uint64_t SampleNumbers::step_by_key(const SensorLayout& layout, std::int64_t key) const {
  std::int64_t step = key - last_->key;
  if (layout.key_is_time) { // the numbers follow the nominal rate where there is one
    step =
        layout.nominal_rate_hz > 0.0
            ? std::llround(static_cast<double>(step) * layout.key_tick_s * layout.nominal_rate_hz)
            : 1;
  }
  const std::int64_t least =
      layout.key_is_time && layout.nominal_rate_hz <= 0.0 && interrupted_ ? 2 : 1;
  return static_cast<std::uint64_t>(std::max(step, least));
}

std::uint64_t SampleNumbers::step_by_arrival(const SensorLayout& layout,
                                             std::int64_t kernel_ns) const {
  std::uint64_t step = 1 + frames_dropped_ / layout.messages.size();
  if (layout.nominal_rate_hz > 0.0) {
    constexpr double gap_intervals = 1.5;
    const double intervals =
        static_cast<double>(kernel_ns - last_->kernel_ns) * 1e-9 * layout.nominal_rate_hz;
    if (intervals > gap_intervals) {
      step = std::max(step, static_cast<std::uint64_t>(std::llround(intervals)));
    }
  }
  // How many an interruption has cost is unknown; at least one is reported, so that it shows.
  return interrupted_ ? std::max<std::uint64_t>(step, 2) : step;
}

} // namespace dyncal::drivers::can
