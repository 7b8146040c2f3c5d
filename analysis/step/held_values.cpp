#include "analysis/step/held_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace dyncal::analysis {
namespace {

constexpr double margin = 1.3;
constexpr double deviations = 6.0;
constexpr double always_allowed = 3.0;
// Of the amplitude: with fewer codes, and noise below a third of a step, equal neighbours are where
// the codes happen to lie.
constexpr double coarse_step = 0.1;

double chance_of_equal(const SampledSine& sine) {
  if (!(sine.step > 0.0)) {
    return 0.0;
  }
  constexpr int phases = 256, draws = 21;
  constexpr double widest = 4.0; // standard deviations
  const double fastest = 2.0 * std::sin(0.5 * sine.turn_rad) * sine.amplitude;
  // At least what the slope changes by from phase to phase, which leaves its mean as it is.
  const double noise = std::max({std::numbers::sqrt2 * sine.noise_sd,
                                 std::abs(fastest) * std::numbers::pi / phases, 1e-3 * sine.step});
  double sum = 0.0;
  for (int i = 0; i < phases; ++i) {
    const double phase = std::numbers::pi * (i + 0.5) / phases;
    const double moved = fastest * std::cos(phase);
    if (noise > sine.step) { // the density at 0: draws are too coarse
      sum += sine.step / (noise * std::sqrt(2.0 * std::numbers::pi)) *
             std::exp(-0.5 * std::pow(moved / noise, 2));
      continue;
    }
    double equal = 0.0, weights = 0.0;
    for (int k = 0; k < draws; ++k) {
      const double g = widest * (2.0 * k / (draws - 1) - 1.0);
      const double weight = std::exp(-0.5 * g * g);
      weights += weight;
      equal += weight * std::max(0.0, 1.0 - std::abs(moved + noise * g) / sine.step);
    }
    sum += equal / weights;
  }
  return sum / phases;
}

} // namespace

double repeated_beyond_chance(std::span<const double> values, const std::vector<ValueBlock>& blocks,
                              const SampledSine& sine) {
  if (sine.step > coarse_step * sine.amplitude && 3.0 * sine.noise_sd < sine.step) {
    return 0.0;
  }
  std::uint64_t equal = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    if (!blocks[k].repeats) {
      continue;
    }
    const std::size_t end = std::min((k + 1) * value_block_samples, values.size());
    for (std::size_t i = k * value_block_samples + 1; i < end; ++i) {
      equal += values[i] == values[i - 1] ? 1 : 0;
    }
  }
  if (static_cast<double>(equal) <= always_allowed) {
    return 0.0;
  }
  const double n = static_cast<double>(values.size() - 1);
  const double expected = n * chance_of_equal(sine);
  const double count = static_cast<double>(equal);
  const double limit = margin * expected + deviations * std::sqrt(expected) + always_allowed;
  return count > limit ? (count - expected) / n : 0.0;
}

} // namespace dyncal::analysis
