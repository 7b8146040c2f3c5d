#include "analysis/uncertainty/noise_near_signal.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  SineFit fit;
};

// A sine of 1 at 1 kS/s with AR(1) noise of standard deviation 0.01.
Record record_of(double frequency_hz, std::size_t samples, double memory, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 0.01 * std::sqrt(1.0 - memory * memory));
  Record record;
  double noise = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    noise = memory * noise + normal(random);
    const double t = static_cast<double>(i) * 1e-3;
    record.stamps_ns.push_back(1'000'000LL * static_cast<std::int64_t>(i));
    record.values.push_back(std::sin(2.0 * pi * frequency_hz * t) + noise);
  }
  const std::span<const double> channel[] = {record.values};
  record.fit = fit_sine(Frequency::from_hz(frequency_hz), 0, record.stamps_ns, channel)->front();
  return record;
}

// Density of AR(1) noise over that of white noise of the same variance.
double density_of(double memory, double frequency_hz) {
  const double turn = 2.0 * pi * frequency_hz * 1e-3;
  return (1.0 - memory * memory) / (1.0 + memory * memory - 2.0 * memory * std::cos(turn));
}

NoiseNearSignal from_blocks(const Record& record, double frequency_hz) {
  const FittedValues values[] = {{record.values, record.fit}};
  const auto blocks =
      phasors_in_blocks(Frequency::from_hz(frequency_hz), 0, record.stamps_ns, values);
  return noise_from_blocks(blocks.front(), record.fit);
}

TEST(NoiseNearSignal, WhiteNoiseKeepsTheUncertaintyOfTheFit) {
  int other = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    other += from_blocks(record_of(80.0, 3000, 0.0, seed), 80.0).white ? 0 : 1;
  }
  EXPECT_EQ(other, 0);
}

TEST(NoiseNearSignal, NoiseThatIsLessNearTheSignalNarrows) {
  for (const double memory : {-0.9, 0.99}) {
    const auto noise = from_blocks(record_of(80.0, 3000, memory, 7), 80.0);
    EXPECT_FALSE(noise.white);
    // Blocks of two periods take some of the slow noise of 0.99 with them, which is cautious.
    const double ratio = noise.factor / std::sqrt(density_of(memory, 80.0));
    EXPECT_GT(ratio, 0.8) << memory;
    EXPECT_LT(ratio, memory < 0.0 ? 1.2 : 2.0) << memory;
    EXPECT_GT(noise.degrees_of_freedom, 100.0);
  }
}

TEST(NoiseNearSignal, OfThreePeriodsWithSlowNoiseIsWider) {
  double squares = 0.0;
  constexpr int draws = 40;
  for (unsigned seed = 1; seed <= draws; ++seed) {
    const Record record = record_of(0.4, 7500, 0.98, seed);
    const auto noise = noise_of_few_periods(Frequency::from_hz(0.4), 0, record.stamps_ns,
                                            record.values, record.fit);
    EXPECT_FALSE(noise.white);
    EXPECT_EQ(noise.degrees_of_freedom, 8.0); // 1, 2, 4 and 5 / T
    squares += noise.factor * noise.factor / draws;
  }
  EXPECT_NEAR(squares / density_of(0.98, 0.4), 1.0, 0.3);
}

TEST(NoiseNearSignal, OfThreePeriodsWithWhiteNoiseSaysNothing) {
  int other = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Record record = record_of(0.4, 7500, 0.0, seed);
    other += noise_of_few_periods(Frequency::from_hz(0.4), 0, record.stamps_ns, record.values,
                                  record.fit)
                     .white
                 ? 0
                 : 1;
  }
  EXPECT_LE(other, 4);
}

} // namespace
} // namespace dyncal::analysis
