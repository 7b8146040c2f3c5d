#include "analysis/uncertainty/ratio_scatter.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

struct Pair {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> numerator, denominator;
};

// 80 Hz for two seconds; `hum` is a line at 83 Hz in the numerator alone.
Pair pair_of(double noise, double hum) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, noise);
  Pair pair;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 1e-3;
    pair.stamps_ns.push_back(1'000'000ll * i);
    pair.numerator.push_back(std::sin(2.0 * std::numbers::pi * 80.0 * t) +
                             hum * std::sin(2.0 * std::numbers::pi * 83.3 * t) + normal(random));
    pair.denominator.push_back(std::sin(2.0 * std::numbers::pi * 80.0 * t + 1.0) + normal(random));
  }
  return pair;
}

std::optional<RatioScatter> scatter_of(const Pair& pair) {
  return ratio_scatter(*Frequency::parse("80"), pair.stamps_ns, pair.numerator, pair.denominator);
}

TEST(RatioScatter, OfWhiteNoiseIsWhatTheoryGives) {
  const auto scatter = scatter_of(pair_of(0.01, 0.0));
  ASSERT_TRUE(scatter.has_value());
  const double expected = 0.01 * std::sqrt(2.0 / 2000.0);
  EXPECT_GT(scatter->u_magnitude_rel, 0.4 * expected);
  EXPECT_LT(scatter->u_magnitude_rel, 2.0 * expected);
  EXPECT_GT(scatter->u_phase_rad, 0.4 * std::sqrt(2.0) * expected);
  EXPECT_LT(scatter->u_phase_rad, 2.0 * std::sqrt(2.0) * expected);
  EXPECT_GE(scatter->degrees_of_freedom, 3.0);
  EXPECT_LE(scatter->degrees_of_freedom, 15.0);
}

TEST(RatioScatter, ALineThatBeatsWithTheSignalShows) {
  const auto clean = scatter_of(pair_of(0.001, 0.0)), disturbed = scatter_of(pair_of(0.001, 0.05));
  ASSERT_TRUE(clean && disturbed);
  EXPECT_GT(disturbed->u_magnitude_rel, 20.0 * clean->u_magnitude_rel);
}

TEST(RatioScatter, TooFewPeriodsOrNoSignalSayNothing) {
  Pair pair = pair_of(0.01, 0.0);
  const auto first = [&](std::size_t n) {
    return ratio_scatter(*Frequency::parse("80"), std::span(pair.stamps_ns).first(n),
                         std::span<const double>(pair.numerator).first(n),
                         std::span<const double>(pair.denominator).first(n));
  };
  EXPECT_FALSE(first(40).has_value()); // 3.2 periods
  EXPECT_TRUE(first(2000).has_value());
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  for (double& value : pair.numerator) {
    value = normal(random);
  }
  EXPECT_FALSE(scatter_of(pair).has_value());
}

TEST(SignificantExcess, StaysSilentWithinWhatNoiseDoes) {
  EXPECT_EQ(significant_excess(1.2e-3, 1e-3, 15.0), 0.0);
  EXPECT_EQ(significant_excess(0.5e-3, 1e-3, 15.0), 0.0);
  EXPECT_NEAR(significant_excess(5e-3, 3e-3, 15.0), 4e-3, 1e-15);
  // chi-squared with 15 degrees of freedom exceeds 37.70 once in a thousand.
  const double limit = std::sqrt(37.70 / 15.0);
  EXPECT_EQ(significant_excess(0.98 * limit, 1.0, 15.0), 0.0);
  EXPECT_GT(significant_excess(1.02 * limit, 1.0, 15.0), 0.0);
}

} // namespace
} // namespace dyncal::analysis
