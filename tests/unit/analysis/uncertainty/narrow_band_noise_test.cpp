#include "analysis/uncertainty/narrow_band_noise.hpp"

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

constexpr std::size_t blocks = 48; // of 1.5 s
constexpr double duration_s = 1.5;

// White noise of variance 1 and narrow-band noise of another, a frequency away from the sine.
struct Noise {
  double width_hz = 0.0;
  double away_hz = 0.0;
  double variance = 0.0;
};

std::vector<Complex> drawn(const Noise& noise, std::mt19937_64& random) {
  constexpr int parts = 4; // of a block
  std::normal_distribution<double> normal(0.0, 1.0);
  const double part_s = duration_s / (blocks * parts);
  const double keeps = std::exp(-std::numbers::pi * noise.width_hz * part_s);
  const double fresh = std::sqrt(1.0 - keeps * keeps);
  Complex slow{normal(random), normal(random)};
  std::vector<Complex> values;
  for (std::size_t k = 0; k < blocks; ++k) {
    Complex value{normal(random), normal(random)};
    for (int part = 0; part < parts; ++part) {
      const double t = (static_cast<double>(k) * parts + part) * part_s;
      value += std::sqrt(noise.variance) / parts * slow *
               std::polar(1.0, 2.0 * std::numbers::pi * noise.away_hz * t);
      slow = keeps * slow + fresh * Complex{normal(random), normal(random)};
    }
    values.push_back(value);
  }
  return values;
}

Complex mean_of_values(const std::vector<Complex>& values) {
  Complex sum;
  for (const Complex& value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

struct Outcome {
  double covered = 0.0; // of all means
  double width = 0.0;   // usual U over 2 rms of the errors
};

Outcome outcome_of(const Noise& noise, int draws, unsigned seed) {
  std::mt19937_64 random(seed);
  const double white = 1.0 / std::sqrt(static_cast<double>(blocks));
  Outcome outcome;
  double squares = 0.0;
  std::vector<double> all_u;
  for (int i = 0; i < draws; ++i) {
    const std::vector<Complex> values = drawn(noise, random);
    const Complex mean = mean_of_values(values);
    const MeanFactor factor = factor_of_narrow_band_noise(values, 1.0, 1.0);
    for (const auto& [error, times] :
         {std::pair(mean.real(), factor.magnitude), std::pair(mean.imag(), factor.phase)}) {
      outcome.covered += std::abs(error) <= 2.0 * times * white ? 0.5 / draws : 0.0;
      squares += 0.5 * error * error / draws;
      all_u.push_back(times * white);
    }
  }
  std::nth_element(all_u.begin(), all_u.begin() + draws, all_u.end());
  outcome.width = all_u[static_cast<std::size_t>(draws)] / std::sqrt(squares);
  return outcome;
}

class NarrowBandNoise : public testing::TestWithParam<Noise> {};

// 400 means: 95.45 % less three standard deviations of what chance does is 92.3 %.
TEST_P(NarrowBandNoise, IsCoveredAndNotMuchTooWide) {
  const Outcome outcome = outcome_of(GetParam(), 200, 11);
  EXPECT_GE(outcome.covered, 0.923);
  EXPECT_LT(outcome.width, 2.0); // of so few independent pieces Student's factor alone makes 1.3
  EXPECT_GT(outcome.width, 0.9);
}

INSTANTIATE_TEST_SUITE_P(AboutTheSineAndBesideIt, NarrowBandNoise,
                         testing::Values(Noise{2.0, 0.0, 4.0}, Noise{2.0, 0.0, 1e4},
                                         Noise{2.0, 1.0, 40.0}, Noise{2.0, -3.0, 40.0},
                                         Noise{5.0, 0.0, 4.0}, Noise{5.0, 1.0, 1e4},
                                         Noise{5.0, 3.0, 1e4}, Noise{1.0, 3.0, 40.0}));

TEST(NarrowBandNoise, OfWhiteNoiseNothingIsAdded) {
  std::mt19937_64 random(3);
  std::vector<double> factors;
  for (int i = 0; i < 300; ++i) {
    const MeanFactor factor = factor_of_narrow_band_noise(drawn({}, random), 1.0, 1.0);
    factors.push_back(factor.magnitude);
    factors.push_back(factor.phase);
  }
  std::sort(factors.begin(), factors.end());
  EXPECT_EQ(factors[450], 1.0); // three quarters are not even looked at
  EXPECT_LT(factors[594], 1.3); // 99 %
  EXPECT_NEAR(outcome_of({}, 300, 4).covered, 0.9545, 0.025);
}

// What changes the sensitivity alone leaves the phase alone.
TEST(NarrowBandNoise, AWanderingSensitivityIsNotNoiseOfThePhase) {
  std::mt19937_64 random(5);
  double largest_phase = 0.0, least_magnitude = 1e9;
  for (int i = 0; i < 20; ++i) {
    std::vector<Complex> values = drawn({}, random);
    const std::vector<Complex> wanders = drawn({2.0, 0.0, 1e4}, random);
    for (std::size_t k = 0; k < blocks; ++k) {
      values[k] += wanders[k].real();
    }
    const MeanFactor factor = factor_of_narrow_band_noise(values, 1.0, 1.0);
    largest_phase = std::max(largest_phase, factor.phase);
    least_magnitude = std::min(least_magnitude, factor.magnitude);
  }
  EXPECT_LT(largest_phase, 2.0);
  EXPECT_GT(least_magnitude, 50.0);
}

TEST(NarrowBandNoise, OfTooFewValuesOrNoNoiseNothingIsKnown) {
  const std::vector<Complex> three{{1.0, 0.0}, {5.0, 2.0}, {-9.0, 3.0}};
  EXPECT_EQ(factor_of_narrow_band_noise(three, 1.0, 1.0).magnitude, 1.0);
  const std::vector<Complex> four{{1.0, 0.0}, {5.0, 2.0}, {-9.0, 3.0}, {400.0, 1.0}};
  EXPECT_EQ(factor_of_narrow_band_noise(four, 0.0, 1.0).magnitude, 1.0);
  EXPECT_GT(factor_of_narrow_band_noise(four, 1.0, 1.0).magnitude, 30.0);
}

// Sums of large lines neither overflow nor lose what is known.
TEST(NarrowBandNoise, HoweverLargeIsKnownInProportion) {
  std::mt19937_64 random(7);
  std::vector<Complex> values = drawn({2.0, 0.0, 1e4}, random);
  const MeanFactor usual = factor_of_narrow_band_noise(values, 1.0, 1.0);
  for (Complex& value : values) {
    value *= 1e5;
  }
  const MeanFactor large = factor_of_narrow_band_noise(values, 1.0, 1.0);
  EXPECT_NEAR(large.magnitude / usual.magnitude / 1e5, 1.0, 0.1);
}

} // namespace
} // namespace dyncal::analysis
