#include "services/evaluation/channel_faults.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

constexpr double u_gain = 1e-4;

analysis::ChannelFit fit(const std::string& channel, double amplitude) {
  analysis::ChannelFit fit{
      .channel = channel, .frequency = analysis::Frequency::from_hz(80.0), .fit = {}};
  fit.fit.sine = amplitude;
  return fit;
}

StepResult result(std::uint32_t step, double acceleration = 10.0) {
  StepResult result;
  result.channel = "dau/z";
  result.step = step;
  result.repetition = 1;
  result.valid = true;
  result.magnitude = 0.95;
  result.u_magnitude = 4e-4;
  result.phase_rad = 0.5;
  result.u_phase_rad = 4e-4;
  result.fits = {fit("acs/reference", acceleration), fit("dau/z", 0.95 * acceleration)};
  return result;
}

// As the step's own shape shows it.
StepResult bent(std::uint32_t step, double loss_rel, double u, double acceleration = 10.0) {
  StepResult bent = result(step, acceleration);
  bent.peaks = analysis::BentPeaks{.amplitude_error_rel = loss_rel, .u = u, .found = true};
  bent.flags.push_back(make_flag(ResultFlag::peaks_bent));
  return bent;
}

void add_two(ChannelFaults& faults, double loss_rel, double u) {
  faults.add(bent(11, loss_rel, u));
  faults.add(bent(12, loss_rel, u, 12.0));
}

std::vector<std::string> sentences(const ChannelFaults& faults, const StepResult& step) {
  return sentences_of(faults.settled(step).flags);
}

TEST(ChannelFaults, AnEndStopIsThereAtEveryLargerAcceleration) {
  ChannelFaults faults;
  add_two(faults, 0.005, 5e-4);
  for (const double acceleration : {9.8, 10.0, 20.0}) {
    EXPECT_THAT(
        sentences(faults, result(2, acceleration)),
        testing::ElementsAre(HasSubstr("dau/z: its peaks are bent: not shown by this step, "
                                       "but by 2 steps of 10 m/s^2 and more, where 0.5 %")));
  }
  EXPECT_THAT(sentences(faults, result(2, 9.5)), testing::IsEmpty());
}

TEST(ChannelFaults, AnEndStopOfTheReferenceIsThereForEverySensor) {
  ChannelFaults faults;
  add_two(faults, -0.02, 1e-3);
  StepResult other = result(2);
  other.channel = "dau/x";
  EXPECT_THAT(sentences(faults, other), testing::ElementsAre(HasSubstr("acs/reference: its")));
  faults = {};
  add_two(faults, 0.02, 1e-3);
  EXPECT_THAT(sentences(faults, other), testing::IsEmpty());
}

// What chance finds once in a thousand steps is no reason to doubt all others.
TEST(ChannelFaults, TwoStepsAreBelieved) {
  ChannelFaults faults;
  faults.add(bent(1, 0.005, 1e-5));
  EXPECT_THAT(sentences(faults, result(3)), testing::IsEmpty());
  faults.add(bent(2, 0.005, 1e-3));
  EXPECT_EQ(sentences(faults, result(3)).size(), 1U);
}

TEST(ChannelFaults, AStepWhoseOwnHarmonicsExcludeTheLossIsSound) {
  ChannelFaults faults;
  add_two(faults, 0.005, 5e-4);
  StepResult own = result(2);
  own.peaks = analysis::BentPeaks{.amplitude_error_rel = 2e-4, .u = 5e-4};
  EXPECT_EQ(sentences(faults, own).size(), 1U); // it may have filtered them away
  own.fits[1].integrity.emplace().shape.order_of_half_rate = 4.0;
  EXPECT_THAT(sentences(faults, own), testing::IsEmpty());
  own.peaks->u = 1e-3;
  EXPECT_EQ(sentences(faults, own).size(), 1U);
}

TEST(ChannelFaults, ALossFarBelowUIsNotWorthAFlag) {
  ChannelFaults faults;
  add_two(faults, 0.005, 5e-4);
  StepResult wide = result(2);
  wide.u_magnitude = 0.02;
  EXPECT_THAT(sentences(faults, wide), testing::IsEmpty());
}

TEST(ChannelFaults, ALaterAttemptTakesThePlaceOfTheFirst) {
  ChannelFaults faults;
  add_two(faults, 0.005, 5e-4);
  StepResult again = result(11);
  again.attempt = 2;
  faults.add(again);
  EXPECT_THAT(sentences(faults, result(2)), testing::IsEmpty());
  faults.add(bent(11, 0.005, 5e-4)); // comes late
  EXPECT_THAT(sentences(faults, result(2)), testing::IsEmpty());
}

// Six steps of a sensor whose samples are in turn of two that differ by 2 d.
ChannelFaults in_turn(double d, unsigned seed, std::uint32_t steps = 6) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, u_gain);
  ChannelFaults faults;
  for (std::uint32_t step = 1; step <= steps; ++step) {
    StepResult one = result(step);
    const double sign = random() % 2 == 0 ? 1.0 : -1.0;
    one.fits[1].scatter.alternating = {0.0, sign * d + noise(random), u_gain};
    faults.add(one);
  }
  return faults;
}

TEST(ChannelFaults, WhatEveryStepHintsAtIsFoundOverAll) {
  int flagged = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const StepResult settled = in_turn(3.4 * u_gain, seed).settled(result(7));
    flagged += settled.flags.size() == 1 ? 1 : 0;
    if (!settled.flags.empty()) {
      EXPECT_EQ(settled.flags.front().kind, ResultFlag::values_off_stamps);
    }
    ASSERT_EQ(settled.budget.size(), 1U);
    EXPECT_EQ(settled.budget.front().kind, analysis::ContributionKind::structure);
    EXPECT_NEAR(settled.budget.front().u_magnitude_rel, 3.4 * u_gain, 2.0 * u_gain);
    EXPECT_NEAR(settled.u_magnitude,
                std::hypot(4e-4, 0.95 * settled.budget.front().u_magnitude_rel), 1e-12);
  }
  EXPECT_GE(flagged, 95);
}

// Too small to be certain: it counts in u in most runs.
TEST(ChannelFaults, WhatMayBeThereCountsInU) {
  int counted = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    counted += in_turn(2.0 * u_gain, seed).settled(result(7)).budget.empty() ? 0 : 1;
  }
  EXPECT_GE(counted, 85);
}

TEST(ChannelFaults, NoiseIsNoSecondSensor) {
  int counted = 0;
  for (const std::uint32_t steps : {1U, 6U, 100U}) {
    for (unsigned seed = 1; seed <= 300; ++seed) {
      const StepResult settled = in_turn(0.0, seed, steps).settled(result(1));
      counted += settled.budget.empty() ? 0 : 1;
      EXPECT_TRUE(settled.flags.empty());
    }
  }
  EXPECT_LE(counted, 18); // 1 in 100
}

// Hum that folds to half the rate less the frequency of one step.
TEST(ChannelFaults, ALineInOneStepIsNoSecondSensor) {
  ChannelFaults faults = in_turn(0.0, 1);
  StepResult hum = result(7);
  hum.fits[1].scatter.alternating = {0.0, 10.0 * u_gain, u_gain};
  faults.add(hum);
  EXPECT_TRUE(faults.settled(result(1)).flags.empty());
}

} // namespace
} // namespace dyncal::inline evaluation
