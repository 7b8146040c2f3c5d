#include "analysis/uncertainty/block_drift.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

BlockSeries series_of(std::size_t blocks, double sd, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  BlockSeries series{
      .time_s = {}, .log_ratio = {}, .variance_magnitude = 1e-8, .variance_phase = 1e-8};
  for (std::size_t k = 0; k < blocks; ++k) {
    series.time_s.push_back(0.1 * static_cast<double>(k));
    series.log_ratio.emplace_back(sd * normal(random), sd * normal(random));
  }
  return series;
}

TEST(BlockDrift, IsTheStandardDeviationOfALineAndOfABend) {
  std::mt19937_64 random(1);
  BlockSeries series = series_of(40, 0.0, random);
  for (std::size_t k = 0; k < 40; ++k) {
    const double x = (static_cast<double>(k) - 19.5) / 20.0; // even in (-1, 1)
    series.log_ratio[k] += std::complex<double>(0.03 * x, 0.02 * x * x);
  }
  const BlockDrift drift = drift_of(series);
  EXPECT_NEAR(drift.magnitude_rel, 0.03 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(drift.phase_rad, 0.02 * std::sqrt(4.0 / 45.0), 1e-4);
}

TEST(BlockDrift, SeesNoneInNoiseWhiteOrLargerThanStated) {
  int seen = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    const double sd = seed % 2 == 0 ? 1e-4 : 4e-4; // stated: 1e-4
    const BlockDrift drift = drift_of(series_of(25, sd, random));
    seen += (drift.magnitude_rel > 0.0) + (drift.phase_rad > 0.0);
  }
  EXPECT_LT(seen, 600 * 0.06); // three coefficients, once in 10^2 each, some freedom lost
  EXPECT_GT(seen, 0);
}

TEST(BlockDrift, SeesNoneInThreeBlocks) {
  std::mt19937_64 random(2);
  BlockSeries series = series_of(3, 0.0, random);
  series.log_ratio.back() = 1.0;
  EXPECT_EQ(drift_of(series).magnitude_rel, 0.0);
}

} // namespace
} // namespace dyncal::analysis
