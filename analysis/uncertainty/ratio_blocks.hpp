// The ratio of two sines in blocks along their records: whether it stays, what it is where both
// wander alike, and by how much its scatter exceeds white noise.
//
//   d_k = L_num(t_k) - L_den(t_k + offset)   L: of one signal (block_series.hpp)
//
// 1. Two clocks that are linked by sync alone are apart by an offset that is known modulo a period,
//    and to `reach_s` from where the records begin (a triangle). Each candidate has the weight of
//    that triangle and of the likelihood of its d_k, constant but for noise. The sensor's group
//    delay, up to 50 ms or a period, shifts what both share as well: eight parts of it are tried.
//    Where both records show how their signals began, this tells offset and delay together.
// 2. Where either signal varies more than white noise does (once in 10^5), the ratio of the whole
//    records is not the best estimate: blocks of different phase add to a shorter phasor, and the
//    records do not cover the same part of what both share. `correction` is the weighted mean of
//    d_k, ln(ratio in blocks / ratio of the records), with what is lost within blocks, 1/24 of the
//    square of the phase's advance in one; else it is 0, so that clean records keep their value.
// 3. Where d_k show more than white noise, by how much their mean may be off
//    (narrow_band_noise.hpp); and by how much, where the ratio may have changed once: where chance
//    gives the best split of d_k into two levels once in 10^2, U holds either level; the longer
//    alone where the other has less than a quarter of the record and is no change by 4.
// 4. The best split of d_k into two levels is a change where chance gives it once in 10^4, against
//    noise as white as stated or as large as what the split leaves, for every likely offset. It
//    stands beside 2: a step shows in fewer blocks than the scatter of all of them.
//
// Any thread.
#pragma once

#include <complex>
#include <optional>

#include "analysis/uncertainty/block_series.hpp"
#include "analysis/uncertainty/ratio_change.hpp"

namespace dyncal::analysis {

struct SeenOffset {
  double offset_s = 0.0; // added to the numerator's times
  double u_s = 0.0;
};

struct BlockAlignment {
  double offset_s = 0.0; // added to the numerator's times
  double period_s = 0.0; // the offset is known modulo this ...
  double reach_s = 0.0;  // ... and below this; 0: it is known
  // By how the two signals began (sine_onset.hpp): the numerator's onset before its first stamp,
  // less the denominator's. The delay of one behind the other is in it.
  std::optional<SeenOffset> seen{};
};

struct RatioInBlocks {
  std::complex<double> correction{};
  double u_magnitude_rel = 0.0; // of the mean, U / 2; 0 where white noise explains the scatter
  double u_phase_rad = 0.0;
  double u_correction_magnitude_rel = 0.0; // from the offset, and from the loss within blocks
  double u_correction_phase_rad = 0.0;
  std::optional<RatioChange> change{};
};

// Empty where fewer than four blocks overlap.
[[nodiscard]] std::optional<RatioInBlocks>
compare_in_blocks(BlockSeries numerator, BlockSeries denominator, const BlockAlignment& alignment);

} // namespace dyncal::analysis
