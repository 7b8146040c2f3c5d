// How far the frequency of a fitted sine may be off where its noise is not white: a slope of the
// phase along the record that noise with a memory leaves.
//
//   c_n = sum_k p_n(t_k) Im(P_k / P),   n = 0 .. 16      p_n: orthonormal polynomials of the blocks
//   C_n = c_n^2 / v                                      v: what white noise gives a block's phase
//   E[C_n] = w + s g_n                                   g_n: noise that forgets with e^{-a t}, a
//                                                        frequency d beside the sine's
//
// The fit has taken c_0 (phase) and c_1 (frequency) for itself; their neighbours show how large the
// noise is, and so do those of the magnitude, Re(P_k / P), from c_1 on: noise beside a sine moves
// both alike; what moves one of them alone has a prior weight of 0.1. Nothing is known of a, d and
// s beforehand: all of a grid (a T from 0.75 to infinity, d T up to 11), beside white noise (w = 1)
// or without any (w = 0), have the weight that the C_n give them, white noise alone a prior weight
// of 0.7. c_1 is then a mixture of normal distributions; the factor is half of what holds 95.45 %
// of it, over that of white noise, so that 2 u covers though few c_n are known. It is exactly 1
// where the C_n are what white noise gives.
//
// A hum or another line that was not taken out is noise that hardly forgets. Noise that lasts
// longer than the record cannot be told from a frequency (a T = 1: 75 to 90 % covered). P_k:
// phasor_blocks.hpp. Nothing fails. Any thread.
#pragma once

#include <span>

#include "analysis/sine/phasor_blocks.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

// Of a frequency that was estimated on this channel; `noise_variance` is that of a sample, as white
// noise at the frequency of the sine. 1 of fewer than four blocks.
[[nodiscard]] double factor_of_frequency_noise(std::span<const PhasorBlock> blocks,
                                               const SineFit& fit, double noise_variance);

} // namespace dyncal::analysis
