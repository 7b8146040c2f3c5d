// The trigger of an oscilloscope without noise rejection, and its output.
//
// The comparator is ready once the signal has been half its amplitude below the level; from then on
// the first instant at which signal plus noise reach the level triggers. So the trigger comes
// early, by about two and a half standard deviations of the noise divided by the slope. Noise is
// white in a band of 1 MHz: a new value every microsecond, independent of what traces show.
//
// The output's rising edge follows the trigger by `output_delay_s` with a jitter of its own: 236(1)
// ns as in the paper. A rectangle rises in 8 ns and triggers where it crosses the level; noise
// hardly matters there. One thread.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

struct TriggerSettings {
  std::uint64_t seed = 1;
  double sync_amplitude_v = 9.75;
  double noise_v = 0.0975; // of the comparator
  double output_delay_s = 236e-9;
  double u_output_delay_s = 0.0; // of a draw for this instrument
  double output_jitter_s = 1e-9; // from shot to shot
};

struct TriggerEvent {
  double trigger_s = 0.0;     // bench time at which the comparator switched
  double output_edge_s = 0.0; // bench time of the output's rising edge at half its height
};

constexpr double rectangle_rise_s = 8e-9;

// Volts of the sync line at bench time `time_s`, without noise.
[[nodiscard]] double sync_line_v(const Excitation& excitation, double amplitude_v, double time_s);

class TriggerModel {
public:
  explicit TriggerModel(const TriggerSettings& settings);

  // The first trigger in [from_s, until_s). REQUIRES: generator unchanged in between (a change ends
  // a period that has begun).
  [[nodiscard]] std::optional<TriggerEvent>
  first_between(double from_s, double until_s, double level_v, const Excitation& excitation);
  [[nodiscard]] double output_delay_s() const { return output_delay_s_; }

private:
  // Bench time of the crossing that belongs to the rising zero crossing at `zero_s`; nothing when
  // the level is out of reach.
  [[nodiscard]] std::optional<double> crossing(double zero_s, double level_v,
                                               const Excitation& excitation);

  TriggerSettings settings_;
  Random noise_;
  double output_delay_s_;
};

} // namespace dyncal::drivers::virtual_bench
