#include "analysis/uncertainty/rice.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(Rice, NoiseAloneHasRayleighsMeanAndDeviation) {
  EXPECT_NEAR(rice_mean(0.0, 2.0), 2.0 * std::sqrt(0.5 * std::numbers::pi), 1e-12);
  EXPECT_NEAR(rice_standard_deviation(0.0, 2.0), 2.0 * std::sqrt(2.0 - 0.5 * std::numbers::pi),
              1e-12);
}

TEST(Rice, SeriesAndClosedFormMeet) {
  EXPECT_NEAR(rice_mean(20.0 - 1e-9, 1.0), rice_mean(20.0 + 1e-9, 1.0), 1e-7);
  EXPECT_NEAR(rice_standard_deviation(20.0 - 1e-9, 1.0), rice_standard_deviation(20.0 + 1e-9, 1.0),
              1e-5);
}

TEST(Rice, DrawnPhasorsAgree) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise;
  for (const double amplitude : {0.5, 3.0, 8.0}) {
    constexpr int draws = 200'000;
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < draws; ++i) {
      const double length = std::hypot(amplitude + noise(random), noise(random));
      sum += length;
      squares += length * length;
    }
    const double mean = sum / draws;
    const double sd = std::sqrt(squares / draws - mean * mean);
    EXPECT_NEAR(rice_mean(amplitude, 1.0), mean, 4.0 / std::sqrt(draws)) << amplitude;
    EXPECT_NEAR(rice_standard_deviation(amplitude, 1.0), sd, 4.0 / std::sqrt(draws)) << amplitude;
  }
}

TEST(Rice, TheInverseReturnsTheAmplitude) {
  for (const double amplitude : {0.1, 1.0, 3.0, 19.0, 21.0, 1e3, 1e9}) {
    EXPECT_NEAR(amplitude_of_rice_mean(rice_mean(amplitude, 1.0), 1.0) / amplitude, 1.0, 1e-7)
        << amplitude;
  }
  EXPECT_EQ(amplitude_of_rice_mean(1.2, 1.0), 0.0); // shorter than noise alone
  EXPECT_NEAR(amplitude_of_rice_mean(1.2, 0.0), 1.2, 1e-15);
}

} // namespace
} // namespace dyncal::analysis
