#include "analysis/method/shared_bend.hpp"

#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double u_rad = 2e-4;

// Steps of 20 to 210 Hz whose first sample is off by so much in each order, beside noise.
std::vector<StepBend> run_of(double second_s, double third_s, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, u_rad);
  std::vector<StepBend> steps;
  for (const double frequency_hz : {20.0, 40.0, 80.0, 160.0, 210.0}) {
    const double w = 2.0 * std::numbers::pi * frequency_hz;
    const SeriesBend bend{{w * second_s + noise(random), w * third_s + noise(random)},
                          {u_rad, u_rad}};
    steps.push_back({w, bend});
  }
  return steps;
}

std::size_t bent(const std::vector<StepBend>& steps) {
  std::size_t count = 0;
  for (const bool bends : steps_that_bend(steps)) {
    count += bends ? 1 : 0;
  }
  return count;
}

TEST(SharedBend, ADriftThatOneFrequencyShowsIsSharedByAllThatHideIt) {
  std::size_t count = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    count += bent(run_of(-1e-6, 2e-7, seed)); // 0.6 u at 20 Hz, 6.6 u at 210 Hz
  }
  EXPECT_GE(count, 980U); // of 1000; the highest does not show it in one of 100 runs
}

TEST(SharedBend, NoiseShowsNone) {
  std::size_t count = 0;
  for (unsigned seed = 1; seed <= 2000; ++seed) {
    count += bent(run_of(0.0, 0.0, seed)) > 0 ? 1 : 0;
  }
  EXPECT_LE(count, 1U); // 0.1 by chance
}

TEST(SharedBend, WhatTheOthersExcludeIsOfOneStepAlone) {
  for (const std::size_t lost : {0U, 2U, 4U}) {
    for (unsigned seed = 1; seed <= 50; ++seed) {
      std::vector<StepBend> steps = run_of(0.0, 0.0, seed);
      steps[lost].bend.turn_rad[0] += steps[lost].angular_hz * 30e-6; // a sample in one shot
      const std::vector<bool> bends = steps_that_bend(steps);
      for (std::size_t i = 0; i < steps.size(); ++i) {
        EXPECT_EQ(bends[i], i == lost) << lost << ", seed " << seed;
      }
    }
  }
}

TEST(SharedBend, NoStepsShowNothing) {
  EXPECT_TRUE(steps_that_bend({}).empty());
}

} // namespace
} // namespace dyncal::analysis
