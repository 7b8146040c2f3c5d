#include "analysis/sine/phasor_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis {
namespace {

using namespace kernel;

constexpr double min_blocks = 4.0;
constexpr double max_blocks = 256.0;
constexpr double min_block_ns = 20e6; // what moves faster is noise to the ratio of two channels
constexpr double min_samples = 12.0;

void add(DesignSums& total, const DesignSums& part) {
  total = {total.s + part.s, total.c + part.c, total.ss + part.ss, total.sc + part.sc};
}

void add(ResidualSums& total, const ResidualSums& part) {
  total = {total.e + part.e, total.es + part.es, total.ec + part.ec, total.ee + part.ee};
}

class Blocks {
public:
  Blocks(const Frequency& frequency, std::int64_t phase_origin_ns,
         std::span<const std::int64_t> stamps_ns, std::span<const FittedValues> channels)
      : axis_{frequency.turns_per_ns_high(), frequency.turns_per_ns_low(), phase_origin_ns, 0.0},
        stamps_ns_(stamps_ns), channels_(channels), values_(channels.size()),
        parts_(channels.size()), sums_(channels.size()), result_(channels.size()) {
    for (const FittedValues& channel : channels) {
      start_.push_back({channel.fit.sine, channel.fit.cosine, channel.fit.offset});
    }
  }

  // A block that cannot be evaluated is passed over.
  void add_block(std::size_t begin, std::size_t end, double centre_s) {
    if (static_cast<double>(end - begin) < 0.5 * min_samples) {
      return;
    }
    DesignSums design{};
    std::fill(sums_.begin(), sums_.end(), ResidualSums{});
    for (std::size_t i = begin; i < end; i += block_samples) {
      if (!add_part(i, std::min(block_samples, end - i), design)) {
        return;
      }
    }
    const NormalMatrix matrix(static_cast<double>(end - begin), design);
    if (!matrix.well_conditioned()) {
      return;
    }
    for (std::size_t j = 0; j < channels_.size(); ++j) {
      const Solution solution = solve(matrix, sums_[j], start_[j]);
      result_[j].push_back({centre_s,
                            matrix.n,
                            0.5 * (matrix.inverse_aa + matrix.inverse_bb),
                            solution.rss,
                            {solution.p.sine, solution.p.cosine}});
    }
  }

  [[nodiscard]] std::size_t count() const { return result_.empty() ? 0 : result_.front().size(); }
  [[nodiscard]] std::vector<std::vector<PhasorBlock>> take() { return std::move(result_); }

private:
  [[nodiscard]] bool add_part(std::size_t first, std::size_t n, DesignSums& design) {
    for (std::size_t j = 0; j < channels_.size(); ++j) {
      values_[j] = channels_[j].values.data() + first;
    }
    DesignSums part{};
    if (!best_kernel().fit_block(stamps_ns_.data() + first, n, axis_, values_.data(),
                                 values_.size(), start_.data(), part, parts_.data())) {
      return false;
    }
    add(design, part);
    for (std::size_t j = 0; j < sums_.size(); ++j) {
      add(sums_[j], parts_[j]);
    }
    return true;
  }

  TimeAxis axis_;
  std::span<const std::int64_t> stamps_ns_;
  std::span<const FittedValues> channels_;
  std::vector<Parameters> start_;
  std::vector<const double*> values_;
  std::vector<ResidualSums> parts_, sums_;
  std::vector<std::vector<PhasorBlock>> result_;
};

// A phasor that rises by P' a second in a block of whole periods is fitted as
//
//   P + conj(P') e^{-2 i w t} / (2 i w)     t: the end of the block after the phase origin
//
// P' is half the difference of the neighbours.
void take_slopes_out(const Frequency& frequency, std::int64_t first_ns, double block_ns,
                     std::vector<PhasorBlock>& blocks) {
  const std::vector<PhasorBlock> fitted = blocks;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const PhasorBlock& before = fitted[k > 0 ? k - 1 : 0];
    const PhasorBlock& behind = fitted[std::min(k + 1, fitted.size() - 1)];
    const std::complex<double> slope =
        (behind.phasor - before.phasor) / (behind.centre_s - before.centre_s);
    const auto end_ns = first_ns + std::llround(fitted[k].centre_s * 1e9 + 0.5 * block_ns);
    const double turns = frequency.reduced_turns(end_ns);
    blocks[k].phasor -= std::conj(slope) * std::polar(1.0, -4.0 * std::numbers::pi * turns) /
                        std::complex<double>(0.0, 2.0 * frequency.angular());
  }
}

} // namespace

BlockDivision divide_into_blocks(const Frequency& frequency,
                                 std::span<const std::int64_t> stamps_ns) {
  const double period_ns = 1e9 / frequency.hz();
  const double span_ns = static_cast<double>(stamps_ns.back() - stamps_ns.front());
  const double sample_ns = span_ns / static_cast<double>(stamps_ns.size() - 1);
  const double periods = std::floor(span_ns / period_ns);
  if (periods < min_blocks) {
    return {};
  }
  const double shortest_ns =
      std::max({min_block_ns, min_samples * sample_ns, span_ns / max_blocks});
  const double in_block = std::min(std::ceil(shortest_ns / period_ns), periods / min_blocks);
  const double block_ns = std::max(1.0, std::floor(in_block)) * period_ns;
  return {std::floor(span_ns / block_ns), block_ns};
}

NoiseWithinBlocks noise_within(std::span<const PhasorBlock> blocks) {
  NoiseWithinBlocks noise;
  for (const PhasorBlock& block : blocks) {
    noise.rss += block.rss;
    noise.degrees_of_freedom += block.samples - 3.0;
  }
  noise.variance = noise.degrees_of_freedom > 0.0 ? noise.rss / noise.degrees_of_freedom : 0.0;
  return noise;
}

std::vector<std::vector<PhasorBlock>> phasors_in_blocks(const Frequency& frequency,
                                                        std::int64_t phase_origin_ns,
                                                        std::span<const std::int64_t> stamps_ns,
                                                        std::span<const FittedValues> channels) {
  std::vector<std::vector<PhasorBlock>> none(channels.size());
  if (stamps_ns.size() < 2) {
    return none;
  }
  const BlockDivision division = divide_into_blocks(frequency, stamps_ns);
  Blocks blocks(frequency, phase_origin_ns, stamps_ns, channels);
  auto first = stamps_ns.begin();
  for (double k = 1.0; k <= division.blocks; k += 1.0) {
    const auto last = std::lower_bound(first, stamps_ns.end(),
                                       stamps_ns.front() + std::llround(k * division.block_ns));
    blocks.add_block(static_cast<std::size_t>(first - stamps_ns.begin()),
                     static_cast<std::size_t>(last - stamps_ns.begin()),
                     (k - 0.5) * division.block_ns * 1e-9);
    first = last;
  }
  if (static_cast<double>(blocks.count()) < min_blocks) {
    return none;
  }
  auto result = blocks.take();
  for (std::vector<PhasorBlock>& channel : result) {
    take_slopes_out(frequency, stamps_ns.front() - phase_origin_ns, division.block_ns, channel);
  }
  return result;
}

} // namespace dyncal::analysis
