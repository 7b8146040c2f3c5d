// Lines that a record cannot tell from its signal, and what they may do to it: mains hum, and
// harmonics of the excitation that sampling folds onto the excitation.
//
//   |f_line - f| < 1.5 / T                  f_line = |g - fs round(g / fs)|
//   g = 50 Hz, 60 Hz and their multiples up to the tenth; k f, k = 2..10 (2 f lies on f at fs / 3)
//
// A line of amplitude h at the distance d changes the phasor by up to h L(d), L = |sin(pi d T) /
// (pi d T)| and beyond the first half lobe its envelope 1 / (pi d T). Its phase is not known, so
//
//   u(A) / A = u(theta) = h L(d) / (sqrt(2) A)
//
// h has to come from where the line is resolved: the same channel at another step or between two
// steps (`resolved_hum`, one more record each). Where it never was, there is no bound, and the step
// needs a flag. Lines farther away are fitted beside the signal (disturbances.hpp).
//
// Uneven stamps fold less than this says; fs is their mean rate, and what the lines do to such a
// record is bounded all the same. `resolved_hum` fails never: what cannot be fitted is left out.
// Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

enum class LineKind { mains, harmonic };

struct UnresolvedLine {
  LineKind kind = LineKind::mains;
  double line_hz = 0.0;     // g
  int order = 1;            // multiple of the mains frequency, or of the excitation
  double distance_hz = 0.0; // of what sampling makes of it, from the excitation
};

// The nearest first; empty: none. Multiples of the excitation that are mains lines too are mains.
[[nodiscard]] std::vector<UnresolvedLine> unresolved_lines(double frequency_hz, double duration_s,
                                                           double rate_hz);

struct LineUncertainty { // standard uncertainties, of magnitude and phase alike
  double u_magnitude_rel = 0.0;
  double u_phase_rad = 0.0;
};
[[nodiscard]] LineUncertainty line_uncertainty(const UnresolvedLine& line, double line_amplitude,
                                               double signal_amplitude, double duration_s);

struct HumLine {
  double line_hz = 0.0;
  double amplitude = 0.0;
  double u_amplitude = 0.0;
};

// Amplitudes of 50, 100, 150, 60, 120 and 180 Hz beside the fitted sine, where they are resolved
// and below half the rate, seen or not: `amplitude` + 2 `u_amplitude` is an upper limit.
[[nodiscard]] std::vector<HumLine> resolved_hum(const Frequency& frequency, const SineFit& fit,
                                                std::int64_t phase_origin_ns,
                                                std::span<const std::int64_t> stamps_ns,
                                                std::span<const double> values);

} // namespace dyncal::analysis
