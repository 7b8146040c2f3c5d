// Puts the faults of one channel (bench_faults.hpp) into what its instrument measures.
//
//   added    signal (hum_rel sin(2 pi hum_hz t + phase) + drift_rel_per_s s + knock)
//            s: seconds since the generator was last changed, 0 while its output is off
//   cut      x + second_order_rel x^2 / signal, within -soft_lower .. soft_upper
//   held     the value before in a held_part of the samples; every `stuck_every_s` the value of one
//   sample in place of the next ones
//
// End stops are the instrument's own matter: it alone knows its converter. The phase of the hum and
// the first instant of being stuck are drawn from seed and name. One thread.
#pragma once

#include <cstdint>
#include <string_view>

#include "drivers/virtual_bench/model/bench_faults.hpp"
#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

class ChannelDisturbance {
public:
  // `signal`: the amplitude that hum and drift are parts of, in the channel's unit.
  ChannelDisturbance(std::uint64_t seed, std::string_view name, const ChannelFaults& faults,
                     double signal);

  // To add before the converter, in the channel's unit.
  [[nodiscard]] double added(double time_s, const Motion& motion) const;
  // What its curve and its soft ends make of the signal, before noise.
  [[nodiscard]] double cut(double value) const;
  // What the converter delivers in place of `value`. REQUIRES: times rise.
  [[nodiscard]] double held(double value, double time_s);

private:
  ChannelFaults faults_;
  double signal_;
  double hum_phase_rad_ = 0.0;
  double next_stuck_s_ = 0.0;
  std::size_t stuck_left_ = 0;
  double stuck_value_ = 0.0;
  Random held_draws_;
  double before_ = 0.0;
};

} // namespace dyncal::drivers::virtual_bench
