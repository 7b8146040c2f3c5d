#include "analysis/method/shared_start_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double least_u_s = 0.8e-6;
constexpr double u_common_s = 0.5 * least_u_s; // of a reference, a delay
using Random = std::mt19937_64;
using Latency = std::function<double(Random&)>; // of one shot

struct Run {
  std::vector<StartEvidence> steps;
  std::vector<double> errors_s; // of the mean of each step
};

// Shots are noisier at low frequencies, as phases over frequency are.
Run run_of(const Latency& latency, Random& random) {
  std::normal_distribution<double> normal;
  Run run;
  for (const double u_s : {8e-6, 4e-6, 2e-6, 1e-6, least_u_s}) {
    StartEvidence step{8, 0.0, u_s};
    std::vector<double> begins(step.shots);
    double mean_s = 0.0;
    for (double& begin : begins) {
      begin = u_s * normal(random) + latency(random);
      mean_s += begin / static_cast<double>(step.shots);
    }
    for (const double begin : begins) {
      step.squares_s2 += (begin - mean_s) * (begin - mean_s);
    }
    run.steps.push_back(step);
    run.errors_s.push_back(mean_s);
  }
  return run;
}

double none(Random& /*random*/) {
  return 0.0;
}

Latency waiting(double mean_s) {
  return [mean_s](Random& random) {
    return std::exponential_distribution<double>(1.0 / mean_s)(random);
  };
}

Latency within(double width_s) {
  return [width_s](Random& random) {
    return std::uniform_real_distribution<double>(0.0, width_s)(random);
  };
}

Latency scattering(double scatter_s) {
  return [scatter_s](Random& random) {
    return std::normal_distribution<double>(0.0, scatter_s)(random);
  };
}

// Which part of the steps whose run shows nothing is within U.
double covered_in_silence(const Latency& latency, unsigned seed) {
  Random random(seed);
  std::normal_distribution<double> common(0.0, u_common_s);
  double covered = 0.0, silent = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Run run = run_of(latency, random);
    const auto shared = shared_start_scatter(run.steps);
    if (!shared || shared->is_shown) {
      continue;
    }
    for (std::size_t step = 0; step < run.steps.size(); ++step) {
      const auto& [shots, squares_s2, u_s] = run.steps[step];
      const double n = static_cast<double>(shots);
      const double u_mean_s = std::max(u_s, std::sqrt(squares_s2 / (n - 1.0))) / std::sqrt(n);
      silent += 1.0;
      const double u_all_s = std::hypot(u_mean_s, u_common_s, shared->u_latency_s);
      covered += std::abs(run.errors_s[step] + common(random)) <= 2.0 * u_all_s ? 1.0 : 0.0;
    }
  }
  EXPECT_GT(silent, 100.0);
  return covered / silent;
}

TEST(SharedStartScatter, NoiseAloneIsSmallAndNotShown) {
  Random random(31);
  int shown = 0;
  std::vector<double> u_s;
  for (int i = 0; i < 20000; ++i) {
    const auto shared = shared_start_scatter(run_of(none, random).steps);
    ASSERT_TRUE(shared);
    shown += shared->is_shown ? 1 : 0;
    u_s.push_back(shared->u_latency_s);
  }
  EXPECT_LE(shown, 30); // 16 by chance
  std::nth_element(u_s.begin(), u_s.begin() + 10000, u_s.end());
  EXPECT_GT(u_s[10000], 0.3 * least_u_s); // no run excludes less
  EXPECT_LT(u_s[10000], 0.8 * least_u_s);
}

TEST(SharedStartScatter, IsShownWhereMostStepsHideIt) {
  Random random(32);
  int shown = 0;
  double mean_s = 0.0;
  constexpr int runs = 300;
  constexpr double scatter_s = 2e-6;
  for (int i = 0; i < runs; ++i) {
    const auto shared = shared_start_scatter(run_of(scattering(scatter_s), random).steps);
    ASSERT_TRUE(shared);
    shown += shared->is_shown ? 1 : 0;
    mean_s += shared->scatter_s / runs;
    EXPECT_NEAR(shared->u_latency_s / shared->scatter_s, 2.5, 1e-12);
  }
  EXPECT_GE(shown, 288);
  EXPECT_GT(mean_s / scatter_s, 0.95);
  EXPECT_LT(mean_s / scatter_s, 1.15);
}

TEST(SharedStartScatter, WaitsThatNoRunShowsAreInTheUncertainty) {
  unsigned seed = 34;
  for (const double part : {0.3, 0.5, 0.7, 1.0, 1.4}) {
    EXPECT_GE(covered_in_silence(waiting(part * least_u_s), seed++), 0.945) << part;
    EXPECT_GE(covered_in_silence(within(part * least_u_s * std::sqrt(12.0)), seed++), 0.90) << part;
  }
}

TEST(SharedStartScatter, OneStepSeldomSpeaksForTheRun) {
  Random random(33);
  int shown = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<StartEvidence> steps = run_of(none, random).steps;
    steps[3].squares_s2 = 1.0;
    const auto shared = shared_start_scatter(steps);
    ASSERT_TRUE(shared);
    shown += shared->is_shown ? 1 : 0;
    EXPECT_LT(shared->scatter_s, 10.0 * least_u_s); // and not for a second
  }
  EXPECT_LE(shown, 3);
}

TEST(SharedStartScatter, NothingIsKnownOfSingleShots) {
  EXPECT_FALSE(shared_start_scatter({}));
  EXPECT_FALSE(shared_start_scatter(std::vector<StartEvidence>(20, {1, 1.0, 1e-6})));
  EXPECT_FALSE(shared_start_scatter(std::vector<StartEvidence>(20, {5, 1.0, 0.0})));
}

} // namespace
} // namespace dyncal::analysis
