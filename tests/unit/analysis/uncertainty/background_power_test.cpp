#include "analysis/uncertainty/background_power.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// Amplitudes as a spectrum gives them: noise of 1 in both components, known from 12 neighbours.
std::vector<MeasuredBackground> draw(double h, int count, std::mt19937_64& random,
                                     double excitation = 10.0) {
  std::normal_distribution<double> noise;
  std::gamma_distribution<double> known(6.0, 1.0 / 6.0);
  std::vector<MeasuredBackground> measured;
  for (int i = 0; i < count; ++i) {
    measured.push_back(
        {{std::hypot(h + noise(random), noise(random)), std::sqrt(known(random))}, excitation});
  }
  return measured;
}

TEST(BackgroundPower, NothingIsKnownWithoutAMeasurement) {
  EXPECT_FALSE(significant_background({}, 10.0));
  EXPECT_EQ(expected_background({}), 0.0);
}

TEST(BackgroundPower, NoiseIsSeldomSignificantAndCostsLittle) {
  for (const int count : {1, 2, 5, 20, 60}) {
    std::mt19937_64 random(5);
    int significant = 0;
    double square = 0.0;
    constexpr int runs = 2000;
    for (int run = 0; run < runs; ++run) {
      const auto measured = draw(0.0, count, random);
      const auto power = significant_background(measured, 10.0);
      significant += power.has_value();
      square += (power ? *power : expected_background(measured)) / runs;
    }
    EXPECT_LE(significant, 4) << count;
    EXPECT_LT(square, count == 1 ? 3.5 : 1.5) << count;
  }
}

// Noise of a width raises what is beside the frequency too; the step itself may show nothing of it.
TEST(BackgroundPower, WhatExceedsTheNoiseThatIsHeldIsSignificant) {
  const std::vector<MeasuredBackground> broad{{{6.0, 1.5}, 10.0}, {{5.0, 1.4}, 10.0}};
  EXPECT_FALSE(significant_background(broad, 10.0));
  EXPECT_FALSE(significant_background(broad, 10.0, false, 2.0));
  const auto beyond = significant_background(broad, 10.0, false, 0.8);
  ASSERT_TRUE(beyond);
  EXPECT_NEAR(*beyond, (36.0 - 2.0 * 2.25) * (1.0 + 3.0 / 4.0), 0.01);
  std::mt19937_64 random(8);
  int significant = 0;
  for (int run = 0; run < 2000; ++run) { // noise of 1 by Hann's window, as it is held
    const auto noise = draw(0.0, 2, random);
    significant += significant_background(noise, 10.0, false, 1.0 / std::sqrt(1.5)).has_value();
  }
  EXPECT_LE(significant, 4);
}

TEST(BackgroundPower, WhatManyStepsShowIsSignificant) {
  std::mt19937_64 random(6);
  for (int run = 0; run < 100; ++run) {
    const auto few = significant_background(draw(12.0, 3, random), 10.0);
    ASSERT_TRUE(few);
    EXPECT_NEAR(*few, 144.0 * (1.0 + 3.0 / 9.0), 100.0);
    const auto many = significant_background(draw(3.0, 40, random), 10.0);
    ASSERT_TRUE(many);
    EXPECT_GT(*many, 9.0);
    EXPECT_LT(*many, 30.0);
  }
}

MeasuredBackground seen(double amplitude, double excitation) {
  return {{amplitude, 0.01}, excitation};
}

TEST(BackgroundPower, OneDisturbedStepIsNotTakenForAll) {
  const std::vector<MeasuredBackground> measured{seen(1.0, 10.0), seen(0.01, 10.0),
                                                 seen(0.01, 10.0), seen(0.01, 10.0)};
  EXPECT_NEAR(significant_background(measured, 10.0).value(), 0.5 * (1.0 + 3.0 / 16.0), 0.01);
}

TEST(BackgroundPower, GrowsWithTheDriveUnlessTheStepsSayOtherwise) {
  // All driven alike: who knows; the larger.
  const std::vector<MeasuredBackground> alike(40, seen(1.0, 10.0));
  EXPECT_NEAR(significant_background(alike, 10.0).value(), 1.0, 0.01);
  EXPECT_NEAR(significant_background(alike, 50.0).value(), 25.0, 0.1);
  EXPECT_NEAR(significant_background(alike, 2.0).value(), 1.0, 0.01);
  EXPECT_NEAR(significant_background(alike, 50.0, true).value(), 1.0, 0.01);
  // It grew, or did not, from step to step.
  const std::vector<MeasuredBackground> growing{seen(1.0, 10.0), seen(2.0, 20.0), seen(4.1, 40.0)};
  EXPECT_NEAR(significant_background(growing, 10.0).value(), 1.0 + 3.0 / 9.0, 0.1);
  const std::vector<MeasuredBackground> constant{seen(1.0, 10.0), seen(1.05, 20.0),
                                                 seen(1.0, 40.0)};
  EXPECT_NEAR(significant_background(constant, 400.0).value(), 1.05 * (1.0 + 3.0 / 9.0), 0.1);
}

} // namespace
} // namespace dyncal::analysis
