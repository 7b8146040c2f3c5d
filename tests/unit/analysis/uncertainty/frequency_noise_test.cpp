#include "analysis/uncertainty/frequency_noise.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t blocks = 48;
constexpr double noise_rel = 1e-4; // of a block's phasor

// White noise of variance 1 and noise with a memory of another, a frequency beside the sine.
struct Noise {
  double forgets = 0.0;      // over the record
  double offset_turns = 0.0; // over the record
  double variance = 0.0;
};

std::vector<Complex> drawn(const Noise& noise, std::mt19937_64& random) {
  constexpr int parts = 4; // of a block
  std::normal_distribution<double> normal;
  const double part = 1.0 / static_cast<double>(blocks * parts);
  const double keeps = std::exp(-noise.forgets * part);
  const double fresh = std::sqrt(1.0 - keeps * keeps);
  Complex slow{normal(random), normal(random)};
  std::vector<Complex> values;
  double t = 0.0;
  for (std::size_t k = 0; k < blocks; ++k) {
    Complex value{normal(random), normal(random)};
    for (int i = 0; i < parts; ++i, t += part) {
      value += std::sqrt(noise.variance) / parts * slow *
               std::polar(1.0, 2.0 * std::numbers::pi * noise.offset_turns * t);
      slow = keeps * slow + fresh * Complex{normal(random), normal(random)};
    }
    values.push_back(value);
  }
  return values;
}

// What a fit leaves: it takes the mean, and the slope of the phase, which is its error.
struct Fitted {
  std::vector<PhasorBlock> phasors;
  double slope = 0.0; // in units of that of white noise
};

Fitted fitted(const std::vector<Complex>& values) {
  const auto time_of = [](std::size_t k) {
    return (static_cast<double>(k) + 0.5) / static_cast<double>(blocks) - 0.5;
  };
  Complex mean;
  double squares = 0.0, products = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    mean += values[k] / static_cast<double>(values.size());
    squares += time_of(k) * time_of(k);
    products += time_of(k) * values[k].imag();
  }
  Fitted result{{}, products / std::sqrt(squares)};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Complex left = values[k] - mean - Complex(0.0, products / squares * time_of(k));
    PhasorBlock block;
    block.centre_s = 3.0 * time_of(k);
    block.unit_variance = noise_rel * noise_rel;
    block.phasor = 1.0 + noise_rel * left;
    result.phasors.push_back(block);
  }
  return result;
}

SineFit unit_sine() {
  SineFit fit;
  fit.sine = 1.0;
  return fit;
}

struct Outcome {
  double covered = 0.0;
  double width = 0.0; // usual U over 2 rms of the errors
};

Outcome outcome_of(const Noise& noise, int draws, unsigned seed) {
  std::mt19937_64 random(seed);
  Outcome outcome;
  double squares = 0.0;
  std::vector<double> factors;
  for (int i = 0; i < draws; ++i) {
    const Fitted one = fitted(drawn(noise, random));
    factors.push_back(factor_of_frequency_noise(one.phasors, unit_sine(), 1.0));
    outcome.covered += std::abs(one.slope) <= 2.0 * factors.back() ? 1.0 / draws : 0.0;
    squares += one.slope * one.slope / draws;
  }
  std::nth_element(factors.begin(), factors.begin() + draws / 2, factors.end());
  outcome.width = factors[static_cast<std::size_t>(draws) / 2] / std::sqrt(squares);
  return outcome;
}

class FrequencyNoise : public testing::TestWithParam<Noise> {};

// 250 draws: 95.45 % less two and a half standard deviations of what chance does is 92.2 %.
TEST_P(FrequencyNoise, IsCoveredAndNotMuchTooWide) {
  const Outcome outcome = outcome_of(GetParam(), 250, 21);
  EXPECT_GE(outcome.covered, 0.922);
  EXPECT_GT(outcome.width, 0.9);
  EXPECT_LT(outcome.width, 2.0);
}

INSTANTIATE_TEST_SUITE_P(BroadAndNarrow, FrequencyNoise,
                         testing::Values(Noise{1000.0, 0.0, 1e6}, Noise{40.0, 0.0, 4.0},
                                         Noise{40.0, 3.0, 1e4}, Noise{10.0, 0.0, 4.0},
                                         Noise{10.0, 3.0, 1e4}, Noise{3.0, 3.0, 1e4},
                                         Noise{0.01, 6.3, 100.0}));

TEST(FrequencyNoise, OfWhiteNoiseNothingIsAdded) {
  const Outcome outcome = outcome_of({}, 400, 22);
  EXPECT_NEAR(outcome.covered, 0.9545, 0.026);
  std::mt19937_64 random(23);
  int exactly_one = 0;
  double sum = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double factor =
        factor_of_frequency_noise(fitted(drawn({}, random)).phasors, unit_sine(), 1.0);
    exactly_one += factor == 1.0 ? 1 : 0;
    sum += factor;
  }
  EXPECT_GT(exactly_one, 240);
  EXPECT_LT(sum / 300, 1.1);
}

// Of noise that is far larger elsewhere than beside the sine, the residuals say too much.
TEST(FrequencyNoise, MayBeSmallerThanTheResidualsSay) {
  std::mt19937_64 random(24);
  const Fitted one = fitted(drawn({}, random));
  const double factor = factor_of_frequency_noise(one.phasors, unit_sine(), 400.0);
  EXPECT_NEAR(factor, 0.05, 0.03);
}

// A level that wanders tells nothing of the frequency.
TEST(FrequencyNoise, AWanderingLevelIsNotNoiseOfTheFrequency) {
  std::mt19937_64 random(25);
  for (int i = 0; i < 10; ++i) {
    std::vector<Complex> values = drawn({}, random);
    for (std::size_t k = 0; k < blocks; ++k) {
      values[k] += 2.0 * static_cast<double>(k);
    }
    EXPECT_LT(factor_of_frequency_noise(fitted(values).phasors, unit_sine(), 1.0), 2.0);
  }
}

TEST(FrequencyNoise, OfTooFewBlocksOrNoNoiseNothingIsKnown) {
  std::mt19937_64 random(26);
  Fitted one = fitted(drawn({3.0, 0.0, 1e4}, random));
  EXPECT_EQ(factor_of_frequency_noise(one.phasors, unit_sine(), 0.0), 1.0);
  EXPECT_EQ(factor_of_frequency_noise(one.phasors, {}, 1.0), 1.0);
  one.phasors.resize(3);
  EXPECT_EQ(factor_of_frequency_noise(one.phasors, unit_sine(), 1.0), 1.0);
}

} // namespace
} // namespace dyncal::analysis
