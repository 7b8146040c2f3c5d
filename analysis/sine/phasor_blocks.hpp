// The phasor of every channel of a record in blocks of whole periods: how a sine changes along its
// record.
//
//   P_k = P + change of a three-parameter fit to the residuals of block k      k = 0 .. m - 1
//
// All blocks hold the same whole number of periods, at least one, and last 20 ms and 12 samples at
// least; there are 256 at the most. P_k is about the phase origin of the fits, so that its phase
// stays where the frequency is that of the fits; what its slope along the record adds to the fit of
// a block is taken out. One pass over the samples for all channels.
//
// Blocks that are too thin (samples lost) are left out; empty where fewer than four remain. Any
// thread.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

struct PhasorBlock {
  double centre_s = 0.0; // after the first stamp of the record
  double samples = 0.0;
  double unit_variance = 0.0; // of one component of the phasor, for noise of variance 1
  double rss = 0.0;           // about the fit to this block
  std::complex<double> phasor;
};

struct BlockDivision {
  double blocks = 0.0; // 0: the record is too short
  double block_ns = 0.0;
};
// REQUIRES: two stamps.
[[nodiscard]] BlockDivision divide_into_blocks(const Frequency& frequency,
                                               std::span<const std::int64_t> stamps_ns);

struct FittedValues {
  std::span<const double> values;
  SineFit fit;
};

// Variance of the residuals within the blocks: without what the sine does from block to block.
struct NoiseWithinBlocks {
  double variance = 0.0;
  double degrees_of_freedom = 0.0;
  double rss = 0.0;
};
[[nodiscard]] NoiseWithinBlocks noise_within(std::span<const PhasorBlock> blocks);

// One vector a channel. REQUIRES: fits about `phase_origin_ns`, as many values as stamps.
[[nodiscard]] std::vector<std::vector<PhasorBlock>>
phasors_in_blocks(const Frequency& frequency, std::int64_t phase_origin_ns,
                  std::span<const std::int64_t> stamps_ns, std::span<const FittedValues> channels);

} // namespace dyncal::analysis
