#include "analysis/sine/stationary_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr std::size_t blocks = 4;
constexpr std::size_t min_block_samples = 16;
constexpr double min_block_periods = 2.0;
constexpr double significant = 4.5;      // u: by chance 4 in 100 000
constexpr double coherent = 0.8;         // part of the blocks' amplitudes that adds up
constexpr double agreeing = 0.5;         // of the mean amplitude, 2 u included
constexpr double negligible_slope = 0.1; // over the record, of the mean amplitude

using Blocks = std::array<LineAmplitude, blocks>;

std::optional<Blocks> measure_blocks(double line_hz, std::span<const std::int64_t> stamps_ns,
                                     std::span<const double> values) {
  Blocks found;
  const std::size_t samples = values.size() / blocks;
  for (std::size_t k = 0; k < blocks; ++k) {
    const auto block = measure_line(line_hz, stamps_ns.subspan(k * samples, samples),
                                    values.subspan(k * samples, samples));
    if (!block) {
      return std::nullopt;
    }
    found.at(k) = *block;
  }
  return found;
}

bool lasts(const LineAmplitude& whole, const Blocks& found) {
  double mean = 0.0, largest_u = 0.0;
  for (const LineAmplitude& block : found) {
    mean += block.amplitude / static_cast<double>(blocks);
    largest_u = std::max(largest_u, block.u_component);
  }
  if (!(whole.amplitude > coherent * mean)) {
    return false;
  }
  for (const LineAmplitude& block : found) {
    if (!(std::abs(block.amplitude - mean) + 2.0 * block.u_component < agreeing * mean)) {
      return false;
    }
  }
  // Of a straight line through the four, over four of their distances: weights -3, -1, 1, 3.
  const double slope = 0.4 * (3.0 * (found[3].amplitude - found[0].amplitude) + found[2].amplitude -
                              found[1].amplitude);
  const double u_slope = 0.4 * std::sqrt(20.0) * largest_u;
  return std::abs(slope) < std::max(negligible_slope * mean, 3.0 * u_slope);
}

} // namespace

std::optional<LineAmplitude> measure_stationary_line(double line_hz, double seen_hz,
                                                     std::span<const std::int64_t> stamps_ns,
                                                     std::span<const double> values) {
  if (stamps_ns.size() != values.size() || values.size() < blocks * min_block_samples) {
    return std::nullopt;
  }
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double rate_hz = static_cast<double>(values.size() - 1) / duration_s;
  const double min_hz = min_block_periods * static_cast<double>(blocks) / duration_s;
  if (!(seen_hz > min_hz && 0.5 * rate_hz - seen_hz > min_hz)) {
    return std::nullopt;
  }
  const auto whole = measure_line(line_hz, stamps_ns, values);
  if (!whole || !(whole->amplitude > significant * whole->u_component)) {
    return std::nullopt;
  }
  const auto found = measure_blocks(line_hz, stamps_ns, values);
  return found && lasts(*whole, *found) ? whole : std::nullopt;
}

} // namespace dyncal::analysis
