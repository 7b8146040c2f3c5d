#include "drivers/virtual_bench/model/channel_disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double knock_s = 0.01;

} // namespace

ChannelDisturbance::ChannelDisturbance(std::uint64_t seed, std::string_view name,
                                       const ChannelFaults& faults, double signal)
    : faults_(faults), signal_(signal), held_draws_(seed, "held values of " + std::string(name)) {
  Random draws(seed, "disturbance of " + std::string(name));
  hum_phase_rad_ = draws.uniform(0.0, 2.0 * std::numbers::pi);
  next_stuck_s_ = draws.uniform(0.0, faults.stuck_every_s);
}

double ChannelDisturbance::added(double time_s, const Motion& motion) const {
  double value = 0.0;
  if (faults_.hum_rel != 0.0 && (motion.sync_on || !faults_.hum_while_driven)) {
    value += faults_.hum_rel *
             std::sin(2.0 * std::numbers::pi * faults_.hum_hz * time_s + hum_phase_rad_);
  }
  if (motion.sync_on) {
    value += faults_.drift_rel_per_s * motion.since_change_s;
    const double since_knock = (motion.since_change_s - faults_.knock_after_s) / knock_s;
    if (since_knock > 0.0 && since_knock < 1.0) {
      value += faults_.knock_rel * std::sin(std::numbers::pi * since_knock);
    }
  }
  return signal_ * value;
}

double ChannelDisturbance::cut(double value) const {
  const double curved = faults_.second_order_rel != 0.0
                            ? value + faults_.second_order_rel * value * value / signal_
                            : value;
  const double upper = faults_.soft_upper > 0.0 ? std::min(curved, faults_.soft_upper) : curved;
  return faults_.soft_lower > 0.0 ? std::max(upper, -faults_.soft_lower) : upper;
}

double ChannelDisturbance::held(double value, double time_s) {
  if (faults_.held_part > 0.0) {
    const double now = std::exchange(before_, value);
    value = held_draws_.happens(faults_.held_part) ? now : value;
  }
  if (faults_.stuck_samples == 0) {
    return value;
  }
  if (stuck_left_ == 0 && time_s >= next_stuck_s_) {
    stuck_value_ = value;
    stuck_left_ = faults_.stuck_samples;
    next_stuck_s_ = time_s + faults_.stuck_every_s;
  }
  if (stuck_left_ == 0) {
    return value;
  }
  --stuck_left_;
  return stuck_value_;
}

} // namespace dyncal::drivers::virtual_bench
