// From unwrapped phase to acceleration at the frequency of a step: decimation, second difference,
// and samples that the sine approximation takes as those of any transducer.
//
//   1. Displacement and sync go through the same filter (decimation_filter.hpp) to fd = 4..8 f.
//   2. a_n = (s_(n+1) - 2 s_n + s_(n-1)) fd^2, whose gain at f is -4 fd^2 sin(w / 2 fd)^2; sync
//      loses one sample at either end.
//   3. Both are divided by their gain at f, exactly; a_n by that over -w^2.
//
// The residuals of a sine fitted to the acceleration are not white: the filter takes from the upper
// end of the band, so the noise near f is `noise_factor` times (1.07 near 4.2 f, up to 1.25) what
// the fit takes it for, where the acceleration of the table is white noise. White noise of the
// detectors is stated as it is near fd = 4 f, and too large above 5 f, which only a sample rate
// below 8.4 f leads to.
//
// The order matters. A sine fitted to the displacement takes the slow motion of the table for
// excitation (1 kHz, 0.1 m/s^2 beside 1.2 um: 14 %); the second difference at the full rate lets
// the noise of all frequencies in.
//
// Acceleration grows with the phase of the interferometer (`displacement_per_turn_m` below zero
// turns it round). Right at the frequency of the step only: other lines of the spectrum keep the
// gains of filter and difference. Fails: frequency_out_of_range (fs < 4 f), too_few_samples. No
// synchronisation.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/interferometer/decimation_filter.hpp"

namespace dyncal::analysis {

struct MotionSettings {
  double frequency_hz = 0.0;
  double sample_rate_hz = 0.0;
  double displacement_per_turn_m = 0.0; // quadrature_phase.hpp; its sign is the direction
};

struct DecimatedMotion {
  double interval_s = 0.0;
  double first_s = 0.0;      // instant of the first value, after the first sample of the record
  double noise_factor = 1.0; // by which the standard uncertainty of a sine fit is multiplied
  std::vector<double> acceleration_m_s2;
  std::vector<double> sync; // as many, in its own unit
};

class ReferenceMotion {
public:
  [[nodiscard]] static Expected<ReferenceMotion> of_step(const MotionSettings& settings);

  // In blocks of any size, of one channel ahead of the other too.
  void push_turns(std::span<const double> turns) { turns_filter_.push(turns, turns_); }
  void push_sync(std::span<const double> sync) { sync_filter_.push(sync, sync_); }

  [[nodiscard]] double decimated_rate_hz() const;
  // Of what has come so far.
  [[nodiscard]] Expected<DecimatedMotion> decimated() const;

private:
  ReferenceMotion(const MotionSettings& settings, std::size_t factor)
      : settings_(settings), turns_filter_(factor), sync_filter_(factor) {}

  MotionSettings settings_;
  DecimationFilter turns_filter_;
  DecimationFilter sync_filter_;
  std::vector<double> turns_; // decimated
  std::vector<double> sync_;
};

} // namespace dyncal::analysis
