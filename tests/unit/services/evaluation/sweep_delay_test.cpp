#include "services/evaluation/sweep_delay.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr double noise_rad = 1e-4;
constexpr std::array frequencies_hz{10.0, 20.0, 40.0, 63.0, 80.0, 125.0};

struct Sweeps {
  std::vector<SweepPhase> phases;
  double mean_delay_s = 0.0;
};

Sweeps draw(std::size_t count, double delay_s, double phase_rad, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Sweeps result;
  std::vector<double> means(frequencies_hz.size(), 0.0);
  for (std::uint32_t sweep = 1; sweep <= count; ++sweep) {
    const double late_s = delay_s * normal(random);
    const double turned_rad = phase_rad * normal(random);
    result.mean_delay_s += late_s / static_cast<double>(count);
    for (std::size_t f = 0; f < frequencies_hz.size(); ++f) {
      const double phase = turned_rad - 2.0 * std::numbers::pi * frequencies_hz[f] * late_s +
                           noise_rad * normal(random);
      means[f] += phase / static_cast<double>(count);
      result.phases.push_back({sweep, frequencies_hz[f], phase, noise_rad});
    }
  }
  for (std::size_t i = 0; i < result.phases.size(); ++i) {
    result.phases[i].deviation_rad -= means[i % frequencies_hz.size()];
  }
  return result;
}

// Far above the noise of d_r, which is 4e-7 s here.
TEST(SweepDelay, HoldsTheMeanOfDelaysThatSweepsHave) {
  constexpr int draws = 400;
  for (const unsigned seed : {3U, 4U}) {
    std::mt19937_64 random(seed);
    for (const std::size_t count : {3U, 5U}) {
      int covered = 0;
      for (int i = 0; i < draws; ++i) {
        const Sweeps sweeps = draw(count, 1e-5, 0.0, random);
        covered += std::abs(sweeps.mean_delay_s) <= u_delay_of_sweeps(sweeps.phases).expanded();
      }
      EXPECT_NEAR(static_cast<double>(covered) / draws, 0.9545, 0.032) << count << ", " << seed;
    }
  }
}

TEST(SweepDelay, IsNothingWhereOnlyNoiseOrAPhaseScatters) {
  constexpr int draws = 1000;
  std::mt19937_64 random(5);
  for (const std::size_t count : {2U, 3U, 5U}) {
    for (const double phase_rad : {0.0, 1e-2}) {
      int some = 0;
      for (int i = 0; i < draws; ++i) {
        some += u_delay_of_sweeps(draw(count, 0.0, phase_rad, random).phases).u > 0.0 ? 1 : 0;
      }
      EXPECT_LT(some, 0.08 * draws) << count << " sweeps, " << phase_rad; // 0.05 and 4 sigma
    }
  }
}

TEST(SweepDelay, OneSweepOrOneFrequencyTellsNothing) {
  std::mt19937_64 random(6);
  EXPECT_EQ(u_delay_of_sweeps({}).u, 0.0);
  EXPECT_EQ(u_delay_of_sweeps(draw(1, 1e-3, 0.0, random).phases).u, 0.0);
  const std::vector<SweepPhase> one{{1, 80.0, 0.1, 1e-4}, {2, 80.0, -0.1, 1e-4}};
  EXPECT_EQ(u_delay_of_sweeps(one).u, 0.0);
}

} // namespace
} // namespace dyncal::inline evaluation
