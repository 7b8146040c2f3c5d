// One signal along its record, block by block, relative to the phasor of the whole record:
//
//   L_k = ln(P_k / P)     real: magnitude, imaginary: phase; P_k: phasor_blocks.hpp
//
// Neighbours are taken together until they are 5 u strong; no series for a signal that is weaker
// even then, or has fewer than four blocks left. Phases may be referred to a pilot on the same
// clock (sync), so that clock and generator cancel. Any thread.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "analysis/sine/phasor_blocks.hpp"

namespace dyncal::analysis {

inline constexpr std::size_t min_blocks_of_series = 4;

struct BlockSeries {
  std::vector<double> time_s;
  std::vector<std::complex<double>> log_ratio; // L_k
  double variance_magnitude = 0.0;             // of one block, for white noise as within the blocks
  double variance_phase = 0.0;
  bool varies = false;     // in phase, by so much that the phasor of the record is visibly shorter
  double shortening = 0.0; // of the magnitude, by the advance of the phase within blocks
};

[[nodiscard]] std::optional<BlockSeries> block_series(std::span<const PhasorBlock> blocks,
                                                      const SineFit& fit);
// Subtracts the pilot's phase `offset_s` later in its own time.
void refer_phase(BlockSeries& series, const BlockSeries& pilot, double offset_s);

// More than white noise does, once in 10^5.
[[nodiscard]] bool varies(const BlockSeries& series);

// Makes both about as coarse as the coarser one.
void make_alike(BlockSeries& one, BlockSeries& other);

// Linear between the blocks; empty more than half a block outside. REQUIRES: two blocks.
[[nodiscard]] std::optional<std::complex<double>> value_at(const BlockSeries& series,
                                                           double time_s);
[[nodiscard]] double spacing_s(const BlockSeries& series);

[[nodiscard]] std::complex<double> mean_of(std::span<const std::complex<double>> values);
[[nodiscard]] double chi_squared(std::span<const std::complex<double>> values,
                                 std::complex<double> mean, double variance_magnitude,
                                 double variance_phase);

} // namespace dyncal::analysis
