// What a channel shows at any frequency beside the sine that was fitted to it: hum, ripple of an
// amplifier, narrow-band noise, seen in a step whose own excitation is elsewhere.
//
//   a(g) = 2 |sum w_m r_m e^{-2 pi i g t_m}| / (sum w_m sinc(g b))        w: Hann's window
//
// r_m: means of the residuals over intervals b of at most 1 / (8 g_max), so that the transform is
// short whatever the sample rate. Its main lobe is 2 / T to either side; a line farther away leaks
// less than 3 %, so one is told from the constant, half the rate and the excitation with all its
// multiples when 2 / T lies between. The noise is that of the channel beside g, not of the whole
// record: from the median of up to 12 places 2.5 / T to 10 / T away, so that noise of any colour
// counts as noise, and a line does not. Its square is known to about 40 %.
//
// Lines that sampling folds are asked for where they are seen (folded_hz() in
// unresolved_lines.hpp). Nothing fails: what cannot be told is left out. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/sine/unresolved_lines.hpp"

namespace dyncal::analysis {

class BackgroundSpectrum {
public:
  // Of residuals about a sine of `excitation_hz`, for lines up to `max_hz`. Nothing of fewer than
  // 16 samples.
  [[nodiscard]] static std::optional<BackgroundSpectrum>
  of_residuals(double excitation_hz, double max_hz, std::span<const std::int64_t> stamps_ns,
               std::span<const double> residuals);

  // Nothing where the line cannot be told from something else.
  [[nodiscard]] std::optional<LineAmplitude> line(double seen_hz) const;

private:
  BackgroundSpectrum() = default;

  [[nodiscard]] bool stands_apart(double seen_hz) const;
  [[nodiscard]] double square_at(double seen_hz) const;
  [[nodiscard]] std::optional<double> noise_beside(double seen_hz) const;

  double excitation_hz_ = 0.0;
  double duration_s_ = 0.0;
  double rate_hz_ = 0.0;
  double interval_s_ = 0.0; // b
  double line_spacing_hz_ = 0.0;
  std::vector<double> squares_; // of amplitudes
};

} // namespace dyncal::analysis
