#include "analysis/method/shared_start_scatter.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// A run whose shots are noisier at low frequencies, as phases over frequency are.
std::vector<StartEvidence> run_of(double scatter_s, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<StartEvidence> steps;
  for (const double u_s : {8e-6, 4e-6, 2e-6, 1e-6, 0.8e-6}) {
    StartEvidence step{8, 0.0, u_s};
    std::vector<double> begins(step.shots);
    double mean_s = 0.0;
    for (double& begin : begins) {
      begin = std::hypot(u_s, scatter_s) * normal(random);
      mean_s += begin / static_cast<double>(step.shots);
    }
    for (const double begin : begins) {
      step.squares_s2 += (begin - mean_s) * (begin - mean_s);
    }
    steps.push_back(step);
  }
  return steps;
}

TEST(SharedStartScatter, NoiseAloneIsNone) {
  std::mt19937_64 random(31);
  int found = 0;
  constexpr int runs = 20000;
  for (int run = 0; run < runs; ++run) {
    found += shared_start_scatter(run_of(0.0, random)) ? 1 : 0;
  }
  EXPECT_LE(found, 30); // 16 by chance
}

TEST(SharedStartScatter, IsFoundWhereMostStepsHideIt) {
  std::mt19937_64 random(32);
  int found = 0;
  double mean_s = 0.0;
  constexpr int runs = 300;
  constexpr double scatter_s = 2e-6;
  for (int run = 0; run < runs; ++run) {
    if (const auto shared = shared_start_scatter(run_of(scatter_s, random))) {
      ++found;
      mean_s += shared->scatter_s;
      EXPECT_NEAR(shared->u_latency_s / shared->scatter_s, std::sqrt(4.0 / 3.0), 1e-12);
    }
  }
  EXPECT_GE(found, 255);
  EXPECT_GT(mean_s / found / scatter_s, 1.0);
  EXPECT_LT(mean_s / found / scatter_s, 1.3);
}

TEST(SharedStartScatter, OneStepSeldomSpeaksForTheRun) {
  std::mt19937_64 random(33);
  int found = 0;
  for (int run = 0; run < 300; ++run) {
    std::vector<StartEvidence> steps = run_of(0.0, random);
    steps[3].squares_s2 = 1.0;
    found += shared_start_scatter(steps) ? 1 : 0;
  }
  EXPECT_LE(found, 24); // 13 by chance: the others add 3
}

TEST(SharedStartScatter, NothingIsKnownOfSingleShots) {
  EXPECT_FALSE(shared_start_scatter({}));
  EXPECT_FALSE(shared_start_scatter(std::vector<StartEvidence>(20, {1, 1.0, 1e-6})));
  EXPECT_FALSE(shared_start_scatter(std::vector<StartEvidence>(20, {5, 1.0, 0.0})));
}

} // namespace
} // namespace dyncal::analysis
