#include "services/evaluation/line_bounds.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::services {
namespace {

using analysis::LineKind;

constexpr double duration_s = 2.0;
constexpr analysis::UnresolvedLine at_50_hz{LineKind::mains, 50.0, 1, 0.0};
constexpr analysis::UnresolvedLine seventh{LineKind::harmonic, 875.0, 7, 0.0};

ChannelLines sensor(double amplitude) {
  return {.channel = "dau/z",
          .subject = "the sensor",
          .amplitude = amplitude,
          .duration_s = duration_s,
          .unresolved = {},
          .measured = {}};
}

StepResult result(std::uint32_t step, std::vector<ChannelLines> lines) {
  StepResult result;
  result.channel = "dau/z";
  result.step = step;
  result.valid = true;
  result.magnitude = 2.0;
  result.u_magnitude = 0.002;
  result.phase_rad = 0.5;
  result.u_phase_rad = 0.001;
  result.lines = std::move(lines);
  return result;
}

StepResult beside(const analysis::UnresolvedLine& line, double amplitude) {
  ChannelLines lines = sensor(amplitude);
  lines.unresolved = {line};
  StepResult step = result(1, {lines});
  step.provisional = true;
  step.flags = {make_flag(ResultFlag::level_off_plan), make_flag(ResultFlag::mains_not_separated)};
  return step;
}

TEST(LineBounds, AnotherStepBoundsTheMainsInTheUnitOfTheChannel) {
  LineBounds bounds;
  ChannelLines other = sensor(5.0);
  other.measured = {{LineKind::mains, 50.0, 0, {0.01, 1e-4}}};
  bounds.add(result(2, {other}));
  const StepResult settled = bounds.settled(beside(at_50_hz, 10.0));
  ASSERT_EQ(settled.budget.size(), 1U);
  const analysis::Contribution& row = settled.budget.front();
  EXPECT_EQ(row.kind, analysis::ContributionKind::mains_hum);
  EXPECT_EQ(row.repeats, analysis::Repeats::anew);
  EXPECT_NEAR(row.u_phase_rad, 0.001 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(row.u_magnitude_rel, 0.001 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(settled.u_phase_rad, std::sqrt(1.5) * 1e-3, 1e-12);
  EXPECT_NEAR(settled.u_magnitude, 2.0 * std::sqrt(1.5) * 1e-3, 1e-12);
  EXPECT_FALSE(settled.provisional);
  EXPECT_THAT(sentences_of(settled.flags),
              testing::ElementsAre(to_string(ResultFlag::level_off_plan)));
}

TEST(LineBounds, AHarmonicIsAPartOfTheAmplitudeAndRepeats) {
  LineBounds bounds;
  ChannelLines other = sensor(5.0);
  other.measured = {{LineKind::harmonic, 0.0, 9, {0.002, 1e-5}}}; // high ones are alike
  bounds.add(result(2, {other}));
  const StepResult settled = bounds.settled(beside(seventh, 10.0));
  ASSERT_EQ(settled.budget.size(), 1U);
  EXPECT_EQ(settled.budget.front().kind, analysis::ContributionKind::folded_harmonic);
  EXPECT_EQ(settled.budget.front().repeats, analysis::Repeats::common);
  EXPECT_NEAR(settled.budget.front().u_phase_rad, 0.002 / std::sqrt(2.0), 1e-12);
}

TEST(LineBounds, SyncCountsInThePhaseAlone) {
  LineBounds bounds;
  StepResult step = beside(at_50_hz, 10.0);
  step.lines.front().counts_in_magnitude = false;
  step.lines.front().measured = {{LineKind::mains, 50.0, 0, {0.01, 1e-4}}}; // in quiet time
  bounds.add(step);
  const StepResult settled = bounds.settled(step);
  EXPECT_EQ(settled.u_magnitude, 0.002);
  EXPECT_NEAR(settled.u_phase_rad, std::sqrt(1.5) * 1e-3, 1e-12);
}

TEST(LineBounds, WhatWasNeverSeenKeepsItsFlag) {
  LineBounds bounds;
  ChannelLines other = sensor(5.0);
  other.channel = "dau/x"; // another channel says nothing of this one
  other.measured = {{LineKind::mains, 50.0, 0, {0.01, 1e-4}},
                    {LineKind::harmonic, 0.0, 2, {0.01, 1e-4}}};
  bounds.add(result(2, {other}));
  const StepResult settled = bounds.settled(beside(at_50_hz, 10.0));
  EXPECT_TRUE(settled.budget.empty());
  EXPECT_THAT(sentences_of(settled.flags),
              testing::ElementsAre(to_string(ResultFlag::level_off_plan),
                                   "dau/z: hum at 50 Hz cannot be told from the excitation"));
  EXPECT_FALSE(settled.provisional);
  EXPECT_THAT(sentences_of(bounds.settled(beside(seventh, 10.0)).flags),
              testing::Contains("dau/z: harmonic 7 falls on the excitation at this sample rate"));
}

// The results of all channels of a step carry the lines of those that they share.
TEST(LineBounds, AChannelOfAStepCountsOnce) {
  ChannelLines other = sensor(5.0);
  other.measured = {{LineKind::mains, 50.0, 0, {1e-4, 1e-4}}};
  LineBounds once, twice;
  once.add(result(2, {other}));
  twice.add(result(2, {other}));
  twice.add(result(2, {other}));
  const StepResult step = beside(at_50_hz, 10.0);
  ASSERT_FALSE(once.settled(step).budget.empty());
  EXPECT_EQ(once.settled(step).u_phase_rad, twice.settled(step).u_phase_rad);
}

} // namespace
} // namespace dyncal::services
