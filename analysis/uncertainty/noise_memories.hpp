// Kinds of noise beside a sine that may last: how long they remember, and how far from the sine
// they are. What u of a phasor (narrow_band_noise.hpp) and of a frequency (frequency_noise.hpp) is
// weighed over, beside white noise.
//
//   R(t) = e^(-a |t|) cos(2 pi d t)      over a record of the length T
//
// Constants.
#pragma once

#include <array>

namespace dyncal::analysis {

struct NoiseMemory {
  double forgets; // a T
  double weight;  // of the prior: what a short record hardly shows counts more
};
inline constexpr std::array noise_memories{
    NoiseMemory{0.75, 2.0}, NoiseMemory{1.5, 2.0},  NoiseMemory{3.0, 1.5}, NoiseMemory{6.0, 1.0},
    NoiseMemory{12.0, 1.0}, NoiseMemory{25.0, 1.0}, NoiseMemory{50.0, 1.0}};
inline constexpr std::array noise_offsets{0.0, 0.7, 1.4, 2.8, 5.6, 11.0}; // d T, to either side
inline constexpr double prior_of_white_noise = 0.7;
// Of magnitude and phase together, to each by itself: of few pieces of noise one of the two may
// look white by chance.
inline constexpr double prior_of_noise_together = 0.9;

} // namespace dyncal::analysis
