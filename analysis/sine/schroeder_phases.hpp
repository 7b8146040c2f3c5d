// The waveform of a multi-sine, and phases that keep its peaks low.
//
//   y(t) = sum_k a_k sin(2 pi f_k t + phi_k)
//   phi_k = -2 pi sum_{j<k} (k - j) p_j,   p_j = a_j^2 / sum a^2      (k by ascending frequency)
//
// M. R. Schroeder, "Synthesis of low-peak-factor signals and binary sequences with low
// autocorrelation", IEEE Trans. Inf. Theory 16 (1970) 85, eq. (9). Lines without gaps come to a
// crest factor (peak over rms) of 1.7, 17 lines in third octaves to about 3.5. Phases are lead, in
// (-pi, pi]. Any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dyncal::analysis {

struct MultisineLine {
  double frequency_hz = 0.0; // a multiple of 1 / period
  double amplitude = 0.0;
  double phase_rad = 0.0; // lead, at the beginning of the period
};

// Of lines in ascending order with these amplitudes, of which one at least is not 0.
[[nodiscard]] std::vector<double> schroeder_phases(std::span<const double> amplitudes);

// One period in so many samples, the first at its beginning.
[[nodiscard]] std::vector<double> multisine_waveform(std::span<const MultisineLine> lines,
                                                     double period_s, std::size_t samples);

} // namespace dyncal::analysis
