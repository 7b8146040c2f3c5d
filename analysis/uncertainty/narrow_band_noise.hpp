// How far the mean of a signal along its record may be off where noise has a memory: narrow-band
// noise about the frequency of a step, of which a record holds few independent pieces.
//
//   C_j = |sum_k z_k e^{-2 pi i j k / n}|^2 / (2 n),   0 < |j| <= 16      beside the mean, j = 0
//   E[C_j] = 1 + s n g_j,   Var(mean) = (1 + s n g_0) / n                 z: in white noise's units
//   g_j = 2 Re[1 / y - (1 - e^{-y}) / y^2],   y = a T + 2 pi i (j - d T)
//
// 1 is white noise, g_j the periodogram over a record of length T of noise that forgets with e^{-a
// t} (a = pi times its width) about a frequency that is d away. Nothing is known of a, d and s
// beforehand: all of a grid (a T from 0.75 to 50, d T up to 11, s by steps of 3) have the weight
// that the C_j give them, white noise alone a prior weight of 0.7. Noise beside a sine moves
// magnitude and phase alike; what changes sensitivity or delay does not: both are hypotheses, the
// second with magnitude and phase by themselves and a prior weight of 0.1.
//
// The mean is then off by a mixture of normal distributions. `magnitude` and `phase` are half of
// what holds 95.45 % of it, over that of white noise: so the factor 2 covers, though few pieces are
// known. Exactly 1 where no band of lines exceeds white noise by what it does once in ten records.
// Noise so narrow that it lasts longer than the record (a T < 1) cannot be told from the sine.
//
// Nothing fails. Any thread.
#pragma once

#include <complex>
#include <span>

namespace dyncal::analysis {

struct MeanFactor {
  double magnitude = 1.0;
  double phase = 1.0;
};

// Of equally spaced values, magnitude in the real part, phase in the imaginary one, with the
// variances that white noise gives each value. 1 of fewer than four.
[[nodiscard]] MeanFactor factor_of_narrow_band_noise(std::span<const std::complex<double>> values,
                                                     double variance_magnitude,
                                                     double variance_phase);

} // namespace dyncal::analysis
