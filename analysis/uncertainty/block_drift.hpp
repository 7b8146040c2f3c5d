// How much a signal drifts along its record, by its blocks (block_series.hpp): what the mean over
// this record may be off that over another one of the same step, whose overlap is not known.
//
//   s_block^2 = sum_j c_j^2,   c_j = mean_k(p_j(t_k) L_k),   mean_k(p_i p_j) = delta_ij
//
// p_1 ... p_3 are polynomials of the times of the blocks, orthogonal to each other and to 1: what
// changes faster than a cubic averages out in both records. A c_j counts where chance gives it once
// in 10^2, against noise as white as within the blocks or as large as what the cubic leaves, so
// that noise near the frequency, which the fit knows already, is no drift. Fewer than four blocks
// show none. Any thread.
#pragma once

#include "analysis/uncertainty/block_series.hpp"

namespace dyncal::analysis {

struct BlockDrift { // standard deviations over the blocks
  double magnitude_rel = 0.0;
  double phase_rad = 0.0;
};

[[nodiscard]] BlockDrift drift_of(const BlockSeries& series);

} // namespace dyncal::analysis
