#include "drivers/virtual_bench/model/dau_clock.hpp"

#include <cmath>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double wander_sd = 8e-9;
constexpr double wander_time_s = 20.0;
constexpr double pulse_jitter_s = 12e-9 * 1.7320508075688772; // half width of the uniform jitter
constexpr double proportional = 0.25; // critically damped loop of 8 s: 2/8 and 1/64
constexpr double integral = 1.0 / 64.0;
constexpr std::size_t slopes_kept = 60;
constexpr std::int64_t second_ns = 1'000'000'000;

} // namespace

DauClock::DauClock(std::uint64_t seed, std::int64_t start_ns)
    : random_(seed, "DAU clock"), start_ns_(start_ns) {
  first_pulse_s_ = -static_cast<double>(start_ns % second_ns) * 1e-9;
  crystal_error_ += random_.normal(0.2e-6);
  wander_ = random_.normal(wander_sd);
  counter_ = std::floor(
      random_.uniform(0.0, 4e9)); // the unit has been on for a while, and its loop has settled
  origin_ = counter_;
  true_rate_ = nominal_hz * (1.0 + crystal_error_ + wander_);
  rate_ = true_rate_;
  for (int i = 0; i < 100; ++i) {
    next_second();
  }
  second_ = 0;
}

void DauClock::next_second() {
  counter_ += true_rate_;
  const double decay = std::exp(-1.0 / wander_time_s);
  wander_ = wander_ * decay + random_.normal(wander_sd * std::sqrt(1.0 - decay * decay));
  true_rate_ = nominal_hz * (1.0 + crystal_error_ + wander_);
  ++second_;

  const double pulse_ticks =
      std::floor(counter_ + true_rate_ * random_.uniform(-pulse_jitter_s, pulse_jitter_s));
  const double predicted = origin_ + rate_;
  const double difference = pulse_ticks - predicted;
  origin_ = predicted + proportional * difference;
  rate_ += integral * difference;

  if (has_pulse_) {
    slopes_.push_back(pulse_ticks - last_pulse_ticks_);
    if (slopes_.size() > slopes_kept) {
      slopes_.pop_front();
    }
    double mean = 0.0;
    for (const double slope : slopes_) {
      mean += slope / static_cast<double>(slopes_.size());
    }
    double square = 0.0;
    for (const double slope : slopes_) {
      square += (slope - mean) * (slope - mean) / static_cast<double>(slopes_.size());
    }
    slope_scatter_ns_ = std::sqrt(square) / nominal_hz * 1e9;
  }
  last_pulse_ticks_ = pulse_ticks;
  has_pulse_ = true;
}

DauStamp DauClock::stamp(double bench_time_s) {
  const double unit_s = bench_time_s - first_pulse_s_;
  while (unit_s >= static_cast<double>(second_ + 1)) {
    next_second();
  }
  const double in_second_s = unit_s - static_cast<double>(second_);
  const double ticks = std::floor(counter_ + in_second_s * true_rate_);
  const double since_ns = (ticks - origin_) / rate_ * 1e9;
  const std::int64_t second_begin_ns = start_ns_ - start_ns_ % second_ns + second_ * second_ns;
  const double dt = since_ns * 1e-9;
  return {
      second_begin_ns + std::llround(since_ns),
      static_cast<std::uint32_t>(std::lround(4.0 * slope_scatter_ns_ * std::sqrt(1.0 + dt * dt))),
      static_cast<std::uint64_t>(ticks)};
}

} // namespace dyncal::drivers::virtual_bench
