// One row of an uncertainty budget: what it is, how it is distributed, and how much of it repeats.
//
// `u_` are standard uncertainties, already multiplied by their sensitivity, so that rows add in
// squares; what is correlated was combined before it became a row (GUM 5.1.2).
//
// `kind` and `repeats` are what programs decide by; `name()` is for people alone and is composed of
// to_string(kind) and the subject: "noise of" and "the reference". `repeats` follows from the kind
// unless a row says otherwise:
//
//   anew          drawn anew in every repetition: averages over repetitions
//   common        the same in all repetitions of a frequency: does not average
//   common_delay  moreover the same error of time at all frequencies: adds in full to a group delay
//
// White stamp noise has both: its scatter is drawn anew, but it always shortens the amplitude, by
// w^2 s_t^2 / 2. `u_lasting_magnitude_rel` is the part of `u_magnitude_rel` that stays the same in
// all repetitions although the row is drawn anew. Plain data, any thread.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "analysis/uncertainty/distribution.hpp"

namespace dyncal::analysis {

inline constexpr double infinite_degrees_of_freedom = std::numeric_limits<double>::infinity();

enum class ContributionKind {
  fit_noise,          // residuals of a sine approximation; subject: the channel
  quantisation,       // steps of a converter that noise does not hide; subject: the channel
  rice,               // how much noise alone lengthens a weak phasor
  structure,          // scatter along the record beyond white noise; subject: the channel
  stamp_jitter,       // white noise of stamps; subject: whose
  stamp_tick,         // quantum of stamps; subject: whose
  sync_jitter,        // instant at which the DAU samples sync, which its stamps do not show
  adc_phase,          // phase lag of the DAU's sync ADC
  channel_delay,      // delay between channels of one instrument; subject: which
  reference,          // calibration of the reference transducer; subject: which part of it, or none
  record_frequency,   // frequency over the distance between the middles of two records
  clock_offset,       // one clock against the other
  apparent_frequency, // of a triggered series, from its middle to its first sample
  trigger_delay,      // of the oscilloscope
  series_start,       // from trigger to first sample of a triggered series
  shots,              // noise and scatter over the shots of a step
  trace_clock,        // rate of the oscilloscope's clock, from the middle of a trace to its trigger
  mains_hum,       // a mains line too near the excitation to be told from it; subject: the channel
  folded_harmonic, // a harmonic that sampling folds onto the excitation; subject: the channel
  background,      // what else there is at the excitation's frequency; subject: the channel
  transverse_motion,      // of the exciter, in a channel across the excited axis
  motion_frequency,       // by which displacement, velocity and acceleration are made of each other
  interferometer_ellipse, // what its covariance leaves of the periodic error
  periodic_error,         // of an interferometer's phase, which no ellipse corrects
  wavelength,             // of the laser, in air
  detector_bandwidth,     // delay and loss of an interferometer's photodetectors
  detector_skew,          // delay of one of its signals against the other
  simultaneity,           // of a reference that was evaluated over another time than the sensor
  other                   // a row that this version does not know; its subject is its name
};

enum class Repeats { anew, common, common_delay };

[[nodiscard]] std::string_view to_string(ContributionKind kind);
[[nodiscard]] std::string_view to_string(Repeats repeats);
[[nodiscard]] Repeats repeats_of(ContributionKind kind);

struct Contribution {
  ContributionKind kind = ContributionKind::other;
  std::string subject{}; // completes the text of the kind; empty where that is complete
  Distribution distribution = Distribution::normal;
  Repeats repeats = repeats_of(kind);
  double degrees_of_freedom = infinite_degrees_of_freedom;
  double u_magnitude_rel = 0.0;
  double u_phase_rad = 0.0;
  double u_lasting_magnitude_rel = 0.0; // part of u_magnitude_rel, see above

  [[nodiscard]] std::string name() const;
};

// Kind and subject of a name() that came as text; `other` for a name this version does not know.
struct NamedKind {
  ContributionKind kind = ContributionKind::other;
  std::string subject;
};
[[nodiscard]] NamedKind parse_contribution_name(std::string_view name);

} // namespace dyncal::analysis
