#include "analysis/response/delay_branches.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<PhasePoint> phases_of(double delay_s, double intercept_rad,
                                  const std::vector<double>& frequencies, double u_rad = 1e-4) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  std::vector<PhasePoint> points;
  for (const double f : frequencies) {
    const double phase = intercept_rad - 2.0 * pi * f * delay_s + u_rad * noise(random);
    points.push_back({f, wrap_phase(phase), u_rad});
  }
  return points;
}

TEST(DelayBranches, FindsEveryDelayThatASensorMayHave) {
  const auto branches = delay_branches(phases_of(30e-3, 0.0, {40, 80, 160}));
  ASSERT_EQ(branches.size(), 2U);
  EXPECT_NEAR(branches[0].line.delay_s, 5e-3, 2e-6);
  EXPECT_NEAR(branches[1].line.delay_s, 30e-3, 2e-6);
}

TEST(DelayBranches, PreferredFrequenciesTellOneDelay) {
  for (const double delay : {0.0, 0.5e-3, 8.1e-3, 30e-3}) {
    for (const double intercept : {0.0, pi}) {
      const auto branches = delay_branches(
          phases_of(delay, intercept, {10, 12.5, 16, 20, 25, 31.5, 40, 50, 63, 80, 100}));
      ASSERT_EQ(branches.size(), 1U) << delay;
      EXPECT_NEAR(branches[0].line.delay_s, delay, 2e-6);
    }
  }
}

TEST(DelayBranches, AResponseThatIsNoDelayHasNone) {
  std::vector<PhasePoint> points;
  for (const double f : {10.0, 20.0, 40.0, 80.0, 160.0, 250.0}) {
    const double r = f / 120.0;
    points.push_back({f, -std::atan2(0.1 * r, 1.0 - r * r), 1e-4});
  }
  EXPECT_TRUE(delay_branches(points).empty());
}

} // namespace
} // namespace dyncal::analysis
