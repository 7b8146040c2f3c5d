#include "services/evaluation/line_bounds.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using analysis::LineKind;

constexpr double duration_s = 2.0;
constexpr analysis::UnresolvedLine at_50_hz{LineKind::mains, 50.0, 1, 0.0};
constexpr analysis::UnresolvedLine seventh{LineKind::harmonic, 875.0, 7, 0.0};

ChannelLines sensor(double amplitude) {
  return {.channel = "dau/z",
          .subject = "the sensor",
          .frequency_hz = 80.0,
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

// So many that nothing is added for few.
void add_others(LineBounds& bounds, const MeasuredLine& measured,
                const MeasuredLine* quiet = nullptr) {
  for (std::uint32_t step = 2; step < 102; ++step) {
    ChannelLines other = sensor(10.0);
    other.frequency_hz = 40.0;
    other.measured = {measured, {LineKind::background, 63.0, 0, {0.5, 1e-5}}};
    if (quiet) {
      other.in_quiet = {*quiet};
    }
    bounds.add(result(step, {other}));
  }
}

double total_phase(const StepResult& settled) {
  double squares = 0.0;
  for (const analysis::Contribution& row : settled.budget) {
    squares += row.u_phase_rad * row.u_phase_rad;
  }
  return std::sqrt(squares);
}

TEST(LineBounds, AnotherStepBoundsTheMainsInTheUnitOfTheChannel) {
  LineBounds bounds;
  add_others(bounds, {LineKind::mains, 50.0, 0, {0.01, 1e-5}});
  const StepResult settled = bounds.settled(beside(at_50_hz, 10.0));
  ASSERT_EQ(settled.budget.size(), 2U);
  const analysis::Contribution& row = settled.budget.front();
  EXPECT_EQ(row.kind, analysis::ContributionKind::mains_hum);
  EXPECT_NEAR(row.u_magnitude_rel, 0.0005, 1e-6);
  EXPECT_NEAR(total_phase(settled), 0.001 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(settled.u_phase_rad, std::sqrt(1.5) * 1e-3, 1e-6);
  EXPECT_NEAR(settled.u_magnitude, 2.0 * std::sqrt(1.5) * 1e-3, 2e-6);
  EXPECT_FALSE(settled.provisional);
  EXPECT_THAT(sentences_of(settled.flags),
              testing::ElementsAre(to_string(ResultFlag::level_off_plan)));
}

// So that a mean of any number keeps u >= h / 2, and hum of any phase lies within 2 u.
TEST(LineBounds, HalfOfHumMayComeAgainInEveryRepetition) {
  LineBounds bounds;
  add_others(bounds, {LineKind::mains, 50.0, 0, {0.01, 1e-5}});
  const StepResult settled = bounds.settled(beside(at_50_hz, 10.0));
  ASSERT_EQ(settled.budget.size(), 2U);
  EXPECT_EQ(settled.budget[0].repeats, analysis::Repeats::anew);
  EXPECT_EQ(settled.budget[1].repeats, analysis::Repeats::common);
  EXPECT_NEAR(settled.budget[1].u_phase_rad, 0.5 * 0.001, 1e-6);
  EXPECT_EQ(settled.budget[0].u_phase_rad, settled.budget[1].u_phase_rad);
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

// An amplifier may hum only while it drives: what quiet time shows counts, but the flag stays.
TEST(LineBounds, QuietTimeAloneKeepsTheFlagOfTheMains) {
  LineBounds bounds;
  StepResult step = beside(at_50_hz, 10.0);
  step.lines.front().counts_in_magnitude = false;
  step.lines.front().in_quiet = {{LineKind::mains, 50.0, 0, {0.01, 1e-5}}};
  bounds.add(step);
  const StepResult settled = bounds.settled(step);
  EXPECT_EQ(settled.u_magnitude, 0.002); // sync counts in the phase alone
  EXPECT_NEAR(settled.u_phase_rad, std::sqrt(1.5) * 1e-3, 1e-6);
  EXPECT_THAT(sentences_of(settled.flags),
              testing::Contains("dau/z: hum at 50 Hz cannot be told from the excitation"));
}

// 420 Hz of 60 Hz folds onto 80 Hz at 500 samples a second.
TEST(LineBounds, NoHighMultipleOfTheMainsIsThereWithoutItsKindred) {
  const analysis::UnresolvedLine seventh_of_60{LineKind::mains, 420.0, 7, 0.0};
  const StepResult step = beside(seventh_of_60, 10.0);
  LineBounds without, with, even;
  add_others(without, {LineKind::mains, 60.0, 0, {1.2e-4, 1e-4}});
  add_others(with, {LineKind::mains, 180.0, 0, {1e-2, 1e-4}});
  add_others(even, {LineKind::mains, 120.0, 0, {1.2e-4, 1e-4}});
  const auto flagged = testing::Contains(testing::HasSubstr("hum at 420 Hz"));
  EXPECT_THAT(sentences_of(without.settled(step).flags), testing::Not(flagged));
  EXPECT_LT(total_phase(without.settled(step)), 1e-5);
  EXPECT_THAT(sentences_of(with.settled(step).flags), flagged);
  EXPECT_THAT(sentences_of(even.settled(step).flags), flagged);
}

TEST(LineBounds, QuietTimeCountsLessWhereDrivenStepsShowLess) {
  LineBounds bounds;
  StepResult step = beside(at_50_hz, 10.0);
  step.lines.front().in_quiet = {{LineKind::mains, 50.0, 0, {0.01, 1e-5}}};
  bounds.add(step);
  add_others(bounds, {LineKind::mains, 50.0, 0, {0.001, 1e-5}},
             &step.lines.front().in_quiet.front());
  EXPECT_NEAR(total_phase(bounds.settled(step)), 1e-4 / std::sqrt(2.0), 1e-7);
}

TEST(LineBounds, WhatOtherStepsShowAtTheFrequencyOfAStepIsItsBackground) {
  LineBounds bounds;
  StepResult step = result(1, {sensor(10.0)}); // 80 Hz, beside no line of the mains
  bounds.add(step);
  EXPECT_TRUE(bounds.settled(step).budget.empty());
  add_others(bounds, {LineKind::background, 80.0, 0, {0.01, 1e-5}});
  const StepResult settled = bounds.settled(step);
  ASSERT_EQ(settled.budget.size(), 2U);
  EXPECT_EQ(settled.budget[0].kind, analysis::ContributionKind::background);
  EXPECT_EQ(settled.budget[0].name(), "background in the sensor");
  EXPECT_NEAR(total_phase(settled), 0.001 / std::sqrt(2.0), 1e-6);
  EXPECT_TRUE(settled.flags.empty());
}

// Both are the same noise about the frequency: the scatter along the record, what others show.
TEST(LineBounds, ABackgroundCountsBeyondTheScatterAlongTheRecord) {
  for (const double scatter : {0.0005, 0.0008}) {
    StepResult step = result(1, {sensor(10.0)});
    step.budget = {{.kind = analysis::ContributionKind::structure,
                    .subject = "the ratio of the signals",
                    .u_magnitude_rel = scatter,
                    .u_phase_rad = 0.0}};
    LineBounds bounds;
    bounds.add(step);
    add_others(bounds, {LineKind::background, 80.0, 0, {0.01, 1e-5}});
    const StepResult settled = bounds.settled(step);
    ASSERT_EQ(settled.budget.size(), 3U);
    double magnitude = 0.0;
    for (const analysis::Contribution& row : settled.budget) {
      magnitude += row.u_magnitude_rel * row.u_magnitude_rel;
    }
    EXPECT_NEAR(std::sqrt(magnitude), std::max(scatter, 0.001 / std::sqrt(2.0)), 1e-6);
    EXPECT_NEAR(total_phase(settled), 0.001 / std::sqrt(2.0), 1e-6); // nothing was held of it
  }
}

TEST(LineBounds, ABackgroundBesideTheMainsCountsBeyondThem) {
  LineBounds bounds;
  add_others(bounds, {LineKind::mains, 50.0, 0, {0.01, 1e-5}});
  StepResult step = beside(at_50_hz, 10.0);
  step.lines.front().frequency_hz = 63.0; // where they all show 0.5
  const StepResult settled = bounds.settled(step);
  EXPECT_NEAR(total_phase(settled), 0.05 / std::sqrt(2.0), 1e-5);
  ASSERT_EQ(settled.budget.size(), 4U);
  EXPECT_EQ(settled.budget[0].kind, analysis::ContributionKind::mains_hum);
  EXPECT_EQ(settled.budget[2].kind, analysis::ContributionKind::background);
}

TEST(LineBounds, NoiseIsNoBackground) {
  LineBounds bounds;
  const StepResult step = result(1, {sensor(10.0)});
  bounds.add(step);
  add_others(bounds, {LineKind::background, 80.0, 0, {1.2e-4, 1e-4}});
  EXPECT_TRUE(bounds.settled(step).budget.empty());
  EXPECT_EQ(bounds.settled(step).u_magnitude, step.u_magnitude);
}

// Hum of 0.001 of the amplitude, a quarter of a hertz away: it beats by up to 0.002.
TEST(LineBounds, AChangeIsNoneWhereALineBeatsAsMuch) {
  const analysis::UnresolvedLine near{LineKind::mains, 50.0, 1, 0.25};
  for (const double h : {0.01, 1e-4}) {
    for (const double change : {0.0019, 0.0021}) {
      LineBounds bounds;
      add_others(bounds, {LineKind::mains, 50.0, 0, {h, 1e-5}});
      StepResult step = beside(near, 10.0);
      step.change = {1.0, 0.6 * change, -0.8 * change};
      step.flags.push_back(make_flag(ResultFlag::changed_within_step));
      const bool explained = h == 0.01 && change < 0.002;
      EXPECT_EQ(bounds.settled(step).flags.size(), explained ? 1U : 2U) << h << " " << change;
    }
  }
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
} // namespace dyncal::inline evaluation
