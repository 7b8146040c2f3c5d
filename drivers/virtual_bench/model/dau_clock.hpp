// The clock of the SmartUp Unit: a 108 MHz counter whose rate and origin follow the pulses per
// second of a GPS receiver.
//
//   stamp = second + (ticks - origin) / rate, rounded to nanoseconds
//
// The crystal is 3.1 ppm off and wanders (Ornstein-Uhlenbeck, 8e-9, 20 s); the pulses jitter by 12
// ns (uniform); a proportional and integral loop of 8 s tracks them. The stamp error has a standard
// deviation of about 18.5 ns and stays below 100 ns. Bench time 0 is unit time start_ns().
//
// One thread; times asked for must not fall by more than a second.
#pragma once

#include <cstdint>
#include <deque>

#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

struct DauStamp {
  std::int64_t utc_ns = 0;
  std::uint32_t uncertainty_ns = 0; // as the unit reports it: from the scatter of the slope alone
  std::uint64_t ticks = 0;
};

class DauClock {
public:
  static constexpr double nominal_hz = 108e6;

  DauClock(std::uint64_t seed, std::int64_t start_ns);

  [[nodiscard]] DauStamp stamp(double bench_time_s);
  [[nodiscard]] std::int64_t start_ns() const { return start_ns_; }
  [[nodiscard]] double crystal_error() const { return crystal_error_; } // relative, at the start

private:
  void next_second();

  Random random_;
  std::int64_t start_ns_;
  double first_pulse_s_; // bench time of the second that bench time 0 lies in (not after 0)
  double crystal_error_ = 3.1e-6;
  double wander_ = 0.0;
  std::int64_t second_ = 0; // full seconds since the first pulse, of the stretch the counter is in
  double counter_ = 0.0;    // true ticks at the beginning of that stretch
  double true_rate_ = nominal_hz; // ticks per true second in that stretch
  double origin_ = 0.0;           // estimate of counter_ by the loop
  double rate_ = nominal_hz;      // estimate of true_rate_
  double last_pulse_ticks_ = 0.0;
  bool has_pulse_ = false;
  std::deque<double> slopes_; // ticks between pulses, newest 60
  double slope_scatter_ns_ = 0.0;
};

} // namespace dyncal::drivers::virtual_bench
