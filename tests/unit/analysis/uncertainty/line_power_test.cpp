#include "analysis/uncertainty/line_power.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// Amplitudes that noise of 1 in both components makes of a line of amplitude `h`.
std::vector<MeasuredAmplitude> draw(double h, int count, std::mt19937_64& random) {
  std::normal_distribution<double> noise;
  std::vector<MeasuredAmplitude> measured;
  for (int i = 0; i < count; ++i) {
    measured.push_back({std::hypot(h + noise(random), noise(random)), 1.0});
  }
  return measured;
}

double mean_square(double h, int count) {
  std::mt19937_64 random(7);
  double sum = 0.0;
  constexpr int runs = 300;
  for (int run = 0; run < runs; ++run) {
    sum += square_of_amplitude(draw(h, count, random)).value();
  }
  return sum / runs;
}

TEST(LinePower, IsUnknownWithoutAMeasurement) {
  EXPECT_FALSE(square_of_amplitude({}));
}

TEST(LinePower, WhatIsNotThereCostsLessTheMoreOftenItWasLookedFor) {
  const double once = mean_square(0.0, 1);
  const double five = mean_square(0.0, 5);
  const double forty = mean_square(0.0, 40);
  EXPECT_LT(once, 3.0);
  EXPECT_LT(five, 0.8);
  EXPECT_LT(forty, 0.3);
  EXPECT_GT(once, five);
  EXPECT_GT(five, forty);
  EXPECT_GT(forty, 0.02);
}

TEST(LinePower, IsThatOfALineInTheNoise) {
  EXPECT_NEAR(mean_square(1.5, 20), 2.25, 0.5);
  EXPECT_NEAR(mean_square(1.0, 40), 1.0, 0.3);
  EXPECT_GE(mean_square(3.0, 5), 9.0);
}

TEST(LinePower, TheLargestOfSeenLinesCounts) {
  EXPECT_DOUBLE_EQ(
      square_of_amplitude(std::vector<MeasuredAmplitude>{{10.0, 0.1}, {0.1, 0.1}, {3.0, 0.1}})
          .value(),
      100.0);
  EXPECT_DOUBLE_EQ(square_of_amplitude(std::vector<MeasuredAmplitude>{{2.0, 0.0}}).value(), 4.0);
}

// u of a poor measurement does not spoil what a good one says.
TEST(LinePower, TheBestMeasurementDecides) {
  const double best = square_of_amplitude(std::vector<MeasuredAmplitude>{{1.0, 1.0}}).value();
  EXPECT_NEAR(square_of_amplitude(std::vector<MeasuredAmplitude>{{1.0, 1.0}, {80.0, 60.0}}).value(),
              best, 0.05 * best);
}

} // namespace
} // namespace dyncal::analysis
