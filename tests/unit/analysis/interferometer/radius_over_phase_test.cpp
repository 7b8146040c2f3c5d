#include "analysis/interferometer/radius_over_phase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

void visit(RadiusOverPhase& radii, double from_turns, double to_turns) {
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double turns = from_turns + (to_turns - from_turns) * (i + 0.5) / steps;
    const double phi = 2.0 * std::numbers::pi * turns;
    const double radius = 500.0 + 3.0 * std::cos(phi - 0.3) + 2.0 * std::cos(2.0 * phi) +
                          1.5 * std::sin(4.0 * phi + 0.2);
    radii.add(turns, radius * radius);
  }
}

TEST(RadiusOverPhase, GivesTheHarmonicsOfTheRadius) {
  RadiusOverPhase radii;
  visit(radii, -0.5, 0.1);
  RadiusOverPhase rest;
  visit(rest, 0.0, 0.5);
  radii.add(rest);
  const auto harmonics = radii.harmonics();
  ASSERT_TRUE(harmonics);
  EXPECT_NEAR(harmonics->mean, 500.0, 1e-3);
  EXPECT_NEAR(harmonics->amplitude[0], 3.0, 2e-3);
  EXPECT_NEAR(harmonics->amplitude[1], 2.0, 2e-3);
  EXPECT_NEAR(harmonics->amplitude[2], 0.0, 2e-3);
  EXPECT_NEAR(harmonics->amplitude[3], 1.5, 2e-3);
}

TEST(RadiusOverPhase, GivesItsDeviationsFromPhaseZeroOn) {
  RadiusOverPhase radii;
  visit(radii, -0.5, 0.5);
  const std::vector<double> deviations = radii.deviations();
  ASSERT_EQ(deviations.size(), radius_parts);
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    const double phi = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / radius_parts;
    const double expected =
        3.0 * std::cos(phi - 0.3) + 2.0 * std::cos(2.0 * phi) + 1.5 * std::sin(4.0 * phi + 0.2);
    EXPECT_NEAR(500.0 * deviations[i], expected, 0.02) << i; // the mean of a part
  }
}

// The same signals, corrected by either.
TEST(RadiusOverPhase, IsKnownOfAnotherEllipseThanItWasMeasuredWith) {
  const Ellipse first{.p = 3.0, .q = -2.0, .r = 0.95, .alpha_rad = 0.05, .radius = 500.0};
  const Ellipse second{.p = 5.0, .q = -3.5, .r = 0.953, .alpha_rad = 0.047, .radius = 501.0};
  const kernel::QuadratureCorrection by_first = correction_of(first);
  const kernel::QuadratureCorrection by_second = correction_of(second);
  RadiusOverPhase with_first, with_second;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double turns = (i + 0.5) / steps - 0.5;
    const double phi = 2.0 * std::numbers::pi * turns;
    const double radius = first.radius * (1.0 + 4e-3 * std::cos(4.0 * phi + 0.2));
    with_first.add(turns, radius * radius);
    const double u1 = by_first.p + radius * std::cos(phi);
    const double u2 =
        by_first.q + radius * (std::sin(phi) - std::cos(phi) * by_first.tangent) / by_first.scale;
    const double x = u1 - by_second.p;
    const double y = (u2 - by_second.q) * by_second.scale + x * by_second.tangent;
    with_second.add(std::atan2(y, x) / (2.0 * std::numbers::pi), x * x + y * y);
  }
  const std::vector<double> known = deviations_with(second, with_first.deviations(), first);
  const std::vector<double> measured = with_second.deviations();
  ASSERT_EQ(known.size(), radius_parts);
  double largest = 0.0;
  for (std::size_t i = 0; i < radius_parts; ++i) {
    EXPECT_NEAR(known[i], measured[i], 2e-4) << i; // the phase turns by some thousandths
    largest = std::max(largest, std::abs(measured[i]));
  }
  EXPECT_GT(largest, 5e-3);
  EXPECT_TRUE(deviations_with(second, {}, first).empty());
}

TEST(RadiusOverPhase, AShortArcHasNone) {
  RadiusOverPhase radii;
  visit(radii, -0.4, 0.4);
  EXPECT_FALSE(radii.harmonics());
  EXPECT_TRUE(radii.deviations().empty());
  EXPECT_TRUE(radii.radius(radius_sectors / 2));
  EXPECT_FALSE(radii.radius(0));
  EXPECT_FALSE(RadiusOverPhase().harmonics());
}

TEST(RadiusOverPhase, TheEndsOfTheTurnBelongToASector) {
  RadiusOverPhase radii;
  radii.add(0.5, 4.0);
  radii.add(-0.5, 4.0);
  EXPECT_EQ(radii.radius(0), 2.0);
}

} // namespace
} // namespace dyncal::analysis
