#include "analysis/method/shared_start_scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
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

// Steps of runs of one latency.
struct Tally {
  double silent = 0.0, covered = 0.0; // of runs that show nothing; of those, within U
  double errors = 0.0;                // squares, in U / 2 of their step
  double steps = 0.0;

  [[nodiscard]] double part() const { return covered / silent; }
  [[nodiscard]] double width() const { return std::sqrt(steps / errors); }
  // What 95.45 % fall below once in a thousand. Steps of a run err together as far as the start
  // does; so runs count, not steps.
  [[nodiscard]] double least() const {
    constexpr double probability = 0.9545;
    return probability - 3.09 * std::sqrt(probability * (1.0 - probability) * 5.0 / silent);
  }
};

Tally tally_of(const Latency& latency, unsigned seed) {
  Random random(seed);
  std::normal_distribution<double> common(0.0, u_common_s);
  Tally tally;
  for (int i = 0; i < 1000; ++i) {
    const Run run = run_of(latency, random);
    const auto shared = shared_start_scatter(run.steps);
    EXPECT_TRUE(shared);
    for (std::size_t step = 0; step < run.steps.size(); ++step) {
      const auto& [shots, squares_s2, u_s] = run.steps[step];
      const double n = static_cast<double>(shots);
      const double u_mean_s = std::max(u_s, std::sqrt(squares_s2 / (n - 1.0))) / std::sqrt(n);
      const double u_all_s = std::hypot(u_mean_s, u_common_s, shared->u_latency_s);
      const double error = (run.errors_s[step] + common(random)) / u_all_s;
      tally.steps += 1.0;
      tally.errors += error * error;
      tally.silent += shared->is_shown ? 0.0 : 1.0;
      tally.covered += !shared->is_shown && std::abs(error) <= 2.0 ? 1.0 : 0.0;
    }
  }
  return tally;
}

// A series of twelve shots at one frequency, with what else is uncertain of its phase.
constexpr double lone_u_s = 1.5e-6;
constexpr double lone_common_s = 0.6 * lone_u_s;
constexpr std::size_t lone_shots = 12;
constexpr double lone_resolved_s = 0.549 * lone_u_s; // u*

Tally tally_of_lone_step(const Latency& latency, unsigned seed) {
  Random random(seed);
  std::normal_distribution<double> normal;
  constexpr double n = lone_shots;
  Tally tally;
  for (int i = 0; i < 2000; ++i) {
    std::vector<double> begins(lone_shots);
    std::generate(begins.begin(), begins.end(),
                  [&] { return lone_u_s * normal(random) + latency(random); });
    const double mean_s = std::reduce(begins.begin(), begins.end()) / n;
    StartEvidence step{lone_shots, 0.0, lone_u_s};
    for (const double begin : begins) {
      step.squares_s2 += (begin - mean_s) * (begin - mean_s);
    }
    const auto shared = shared_start_scatter(std::array{step});
    EXPECT_TRUE(shared);
    const double u_mean_s =
        std::max(lone_u_s, std::sqrt(step.squares_s2 / (n - 1.0))) / std::sqrt(n);
    const double u_all_s = std::hypot(std::hypot(u_mean_s, lone_common_s), shared->u_latency_s);
    const double error = (mean_s + lone_common_s * normal(random)) / u_all_s;
    tally.steps += 1.0;
    tally.errors += error * error;
    tally.silent += shared->is_shown ? 0.0 : 1.0;
    tally.covered += !shared->is_shown && std::abs(error) <= 2.0 ? 1.0 : 0.0;
  }
  return tally;
}

constexpr std::array seeds{34U, 134U, 234U};
constexpr double resolved_s = 0.449e-6; // u*: such a scatter is just seen, 2 u* in one run of five

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
  EXPECT_GT(u_s[10000] / resolved_s, 1.6); // no run excludes less
  EXPECT_LT(u_s[10000] / resolved_s, 2.0);
}

// 4.5 u* is shown in 96.7 % of runs; of 3000, 2901 with a standard deviation of 10.
TEST(SharedStartScatter, IsShownWhereMostStepsHideIt) {
  Random random(32);
  int shown = 0;
  double scatters_s = 0.0, latencies_s = 0.0;
  constexpr int runs = 3000;
  constexpr double scatter_s = 2e-6;
  for (int i = 0; i < runs; ++i) {
    const auto shared = shared_start_scatter(run_of(scattering(scatter_s), random).steps);
    ASSERT_TRUE(shared);
    shown += shared->is_shown ? 1 : 0;
    scatters_s += shared->scatter_s / runs;
    latencies_s += shared->u_latency_s / runs;
  }
  EXPECT_GE(shown, 2871);
  EXPECT_NEAR(scatters_s / scatter_s, 1.0, 0.05);
  EXPECT_GT(latencies_s / scatter_s, std::sqrt(3.0)); // what a rectangle may hide
  EXPECT_LT(latencies_s / scatter_s, 2.3);
}

void expect_covered_in_silence(const Tally& tally, double part, unsigned seed) {
  EXPECT_GT(tally.silent, 500.0) << part << ", seed " << seed;
  EXPECT_GE(tally.part(), tally.least()) << part << ", seed " << seed;
}

void expect_not_too_wide(const Tally& tally, double part, unsigned seed) {
  EXPECT_GT(tally.width(), 0.9) << part << ", seed " << seed;
  EXPECT_LT(tally.width(), 1.5) << part << ", seed " << seed;
}

TEST(SharedStartScatter, RectanglesThatNoRunShowsAreInTheUncertainty) {
  for (const unsigned seed : seeds) {
    for (const double part : {0.3, 0.5, 0.7, 1.0, 1.3, 1.6, 2.0, 2.5}) {
      const Tally tally = tally_of(within(part * resolved_s * std::sqrt(12.0)), seed);
      expect_covered_in_silence(tally, part, seed);
      expect_not_too_wide(tally, part, seed);
    }
  }
}

TEST(SharedStartScatter, WaitsThatNoRunShowsAreInTheUncertainty) {
  for (const unsigned seed : seeds) {
    for (const double part : {0.5, 1.0, 2.0, 3.0}) {
      expect_covered_in_silence(tally_of(waiting(part * resolved_s), seed), part, seed);
    }
  }
}

TEST(SharedStartScatter, IsNoWiderThanErrorsAskForWhereItIsNoneOrLarge) {
  for (const unsigned seed : seeds) {
    expect_not_too_wide(tally_of(none, seed), 0.0, seed);
    for (const double part : {5.0, 20.0}) {
      expect_not_too_wide(tally_of(within(part * resolved_s * std::sqrt(12.0)), seed), part, seed);
    }
  }
}

// One step tells little of s. Where U is to be at most 1.5 times what clean errors make it, it
// holds fewer of the rectangles that the step hides.
TEST(SharedStartScatter, LoneStepsAreNotTooWideAndHoldMostOfWhatTheyHide) {
  for (const unsigned seed : seeds) {
    expect_not_too_wide(tally_of_lone_step(none, seed), 0.0, seed);
    for (const double part : {0.5, 1.0, 2.0, 3.0}) {
      const double width_s = part * lone_resolved_s * std::sqrt(12.0);
      const Tally tally = tally_of_lone_step(within(width_s), seed);
      EXPECT_GT(tally.silent, 200.0) << part << ", seed " << seed;
      EXPECT_GT(tally.part(), 0.8) << part << ", seed " << seed;
    }
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
