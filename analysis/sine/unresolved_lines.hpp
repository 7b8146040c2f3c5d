// Lines that a record cannot tell from its signal, and what they may do to it: mains hum, and
// harmonics of the excitation that sampling folds onto the excitation.
//
//   |f_line - f| < 1.5 / T                  f_line = |g - fs round(g / fs)|
//   g = 50 Hz, 60 Hz, or what the bench file calls mains, and their multiples up to the tenth;
//       k f, k = 2..10 (2 f lies on f at fs / 3)
//
// A line of amplitude h at the distance d changes the phasor by up to h L(d), L = |sin(pi d T) /
// (pi d T)| and beyond the first half lobe its envelope 1 / (pi d T). Its phase is not known, so
//
//   u(A) / A = u(theta) = h L(d) / (sqrt(2) A)
//
// h has to come from where the line is resolved: the same channel at another step. Where it never
// was, there is no bound, and the step needs a flag. Lines farther away are fitted beside the
// signal (disturbances.hpp). Of the mains, whose frequency wanders, d counts as smaller by 1e-3 of
// the line's.
//
// Uneven stamps fold less than this says; fs is their mean rate, and what the lines do to such a
// record is bounded all the same. Nothing fails: what cannot be told from something else is left
// out. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/mains.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

// `background`: whatever there is at a frequency that some step excites.
enum class LineKind { mains, harmonic, background };

struct UnresolvedLine {
  LineKind kind = LineKind::mains;
  double line_hz = 0.0;     // g
  int order = 1;            // multiple of the mains frequency, or of the excitation
  double distance_hz = 0.0; // of what sampling makes of it, from the excitation
};

// The nearest first; empty: none. `resolved`: how many 1 / T away a line must be to be none of
// them. Multiples of the excitation that are mains lines too are mains.
[[nodiscard]] std::vector<UnresolvedLine>
unresolved_lines(double frequency_hz, double duration_s, double rate_hz,
                 std::span<const double> mains_hz = usual_mains_hz, double resolved = 1.5);

struct LineUncertainty { // standard uncertainties, of magnitude and phase alike
  double u_magnitude_rel = 0.0;
  double u_phase_rad = 0.0;
};
[[nodiscard]] LineUncertainty line_uncertainty(const UnresolvedLine& line, double line_amplitude,
                                               double signal_amplitude, double duration_s);

// By how much of the signal it may seem to change along the record, for a line that beats with it:
//
//   2 h / A sin(pi d T)      2 h / A from d T = 1 / 2 on; d of the mains larger by their wandering
[[nodiscard]] double largest_beat_rel(const UnresolvedLine& line, double line_amplitude,
                                      double signal_amplitude, double duration_s);

// Where sampling at `rate_hz` puts a line: from 0 to half the rate.
[[nodiscard]] double folded_hz(double line_hz, double rate_hz);

// Whether a line stands apart from the constant, half the rate, the excitation and its multiples up
// to the tenth; of a harmonic `order` (0: a line of the mains) from those below it.
[[nodiscard]] bool is_resolved(double line_hz, int order, double frequency_hz, double duration_s,
                               double rate_hz);

struct LineAmplitude {
  double amplitude = 0.0;
  double u_component = 0.0; // standard uncertainty of its sine and of its cosine part
};

// Of a line in what a fit has left of a record, seen or not. Nothing where it cannot be told from
// the constant.
[[nodiscard]] std::optional<LineAmplitude> measure_line(double line_hz,
                                                        std::span<const std::int64_t> stamps_ns,
                                                        std::span<const double> residuals);

// The values without the sine that was fitted to them, and without its offset.
[[nodiscard]] std::vector<double> residuals_of(const Frequency& frequency, const SineFit& fit,
                                               std::int64_t phase_origin_ns,
                                               std::span<const std::int64_t> stamps_ns,
                                               std::span<const double> values);

} // namespace dyncal::analysis
