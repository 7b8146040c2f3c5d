#include "analysis/interferometer/radius_over_phase.hpp"

#include <cmath>
#include <numbers>

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
