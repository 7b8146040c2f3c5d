// The phase of sync at the trigger point, from the trace that an oscilloscope recorded about it:
//
//   sync(u) = sin(w u + beta) + harmonics,   u = 0 at the trigger point
//
// of the fundamental alone, at the frequency that the ACS found. Harmonics of a distorted sync are
// fitted beside it (2 to 5, as far as the trace shows them) where the trace has a period or more;
// in a shorter one they cannot be told from it, and a harmonic of the part h of the amplitude turns
// beta by up to `leak_rad` h. The offset of the trace is always fitted.
//
// Phases lead, in radians. Fails as sine_fit.hpp does. Any thread.
#pragma once

#include <complex>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct SyncTrace {
  double first_s = 0.0; // of its first sample, 0 at the trigger point
  double interval_s = 0.0;
  std::span<const double> values{};
};

struct TriggerPhase {
  std::complex<double> sync; // at the trigger point
  double u_rad = 0.0;        // of its phase, by noise
};

[[nodiscard]] Expected<TriggerPhase> fit_trigger(const SyncTrace& trace,
                                                 const Frequency& frequency);

[[nodiscard]] double periods_of(const SyncTrace& trace, double frequency_hz);

// By how much a harmonic of sync, of the worst order and phase, turns beta: radians for one as
// large as the fundamental. 0 for a trace of a period or more.
[[nodiscard]] double leak_rad(const SyncTrace& trace, const Frequency& frequency);

} // namespace dyncal::analysis
