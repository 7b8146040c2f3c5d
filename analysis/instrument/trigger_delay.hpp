// Delay of an oscilloscope's trigger output, from traces of sync and of that output taken at once
// (paper section 2.4).
//
// Times u are in seconds from the trigger point of the time axis. The output's rising edge lies at
// u_out, where a straight line through the samples between 20 % and 80 % of its height passes half
// the height:
//
//   rectangle  sync is a rectangle whose edge triggers, found likewise at u_in: tau = u_out - u_in
//   sine       tau = u_out: the axis begins where the scope's trigger lies
//
// For a sine, eqs. (5) to (8) take the phase beta of sync(u) = A sin(w u + beta) + C from the same
// axis, shot by shot. Noise that triggers too early or too late moves beta and must not be in tau a
// second time. How large it is the sine approximation shows: sync passes C at u_0 = -beta / w, and
// u_out - u_0 scatters by the trigger's noise where tau does not.
//
// u(tau): standard deviation of the mean over n shots, of n - 1 degrees of freedom, and the time
// resolution of one trace as a rectangle, interval / sqrt(12), which does not average out when
// trigger and sampling are locked; U = k u by both.
//
// Fails: too_few_samples, no_excitation (no rising edge, or more than one), as sine_fit.hpp does.
// Any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

struct DelayTrace {
  double first_s = 0.0;
  double interval_s = 0.0;
  std::span<const double> sync{};
  std::span<const double> output{};
};

struct ShotDelay {
  double output_delay_s = 0.0;       // tau
  double from_zero_crossing_s = 0.0; // u_out - u_0; for a rectangle the same as tau
};

// Where the trace rises through half of its height.
[[nodiscard]] Expected<double> rising_edge_s(double first_s, double interval_s,
                                             std::span<const double> volts);

[[nodiscard]] Expected<ShotDelay> delay_by_rectangle(const DelayTrace& trace);
[[nodiscard]] Expected<ShotDelay> delay_by_sine(const DelayTrace& trace,
                                                const Frequency& frequency);

struct HistogramOfDelays {
  double first_s = 0.0; // lower end of the first bin
  double width_s = 0.0;
  std::vector<std::size_t> counts;
};

struct TriggerDelay {
  double delay_s = 0.0;
  CombinedUncertainty of_delay{};
  double scatter_s = 0.0; // standard deviation of one shot
  double from_zero_crossing_s = 0.0;
  double scatter_from_zero_crossing_s = 0.0;
  std::size_t shots = 0;
  HistogramOfDelays histogram;
};

[[nodiscard]] Expected<TriggerDelay> mean_trigger_delay(std::span<const ShotDelay> shots,
                                                        double interval_s);

} // namespace dyncal::analysis
