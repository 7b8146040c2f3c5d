// How many neighbours in a sampled sine are equal beyond what the converter's steps make so: values
// that are held when the next one is late, or read again, one sample at a time.
//
//   P(equal) = E[max(0, 1 - |D| / q)],   D = A w T cos(phi) + sqrt(2) s g     q: one step
//
// averaged over phase and normal noise g. Counted as beyond chance: what exceeds 1.3 times the
// expected number, six of its standard deviations and three; neighbouring values whose noise is not
// white are why it is that much. A held part p makes the channel late by p T / 2 or more, at low
// frequencies too, where no single one of them stands out. Steps above a tenth of
// the amplitude that no noise hides are not judged. Any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/sine/sine_residuals.hpp"

namespace dyncal::analysis {

struct SampledSine {
  double amplitude = 0.0;
  double turn_rad = 0.0; // of the phase from one sample to the next
  double noise_sd = 0.0;
  double step = 0.0; // of the converter, 0: none
};

// Part of the neighbours; 0: none beyond chance.
[[nodiscard]] double repeated_beyond_chance(std::span<const double> values,
                                            const std::vector<ValueBlock>& blocks,
                                            const SampledSine& sine);

} // namespace dyncal::analysis
