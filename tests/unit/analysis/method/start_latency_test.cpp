#include "analysis/method/start_latency.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double sample_s = 1e-3;
constexpr double u_s = 2e-6;

std::vector<double> fixed_start(std::size_t shots, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, u_s);
  std::vector<double> offsets(shots);
  for (double& offset : offsets) {
    offset = noise(random);
  }
  return offsets;
}

std::vector<double> uniform_start(std::size_t shots, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> start(-0.5 * sample_s, 0.5 * sample_s);
  std::vector<double> offsets = fixed_start(shots, seed);
  for (double& offset : offsets) {
    offset += start(random);
  }
  return offsets;
}

TEST(StartLatency, ShotsThatScatterWithTheirUncertaintyStartWithTheTrigger) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    EXPECT_EQ(judge_start_latency(fixed_start(5, seed), u_s, sample_s).kind, StartKind::fixed)
        << seed;
  }
}

TEST(StartLatency, ShotsSpreadOverOneSampleComeFromASensorThatRunsFree) {
  int uniform = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const StartLatency start = judge_start_latency(uniform_start(5, seed), u_s, sample_s);
    EXPECT_NE(start.kind, StartKind::fixed) << seed;
    uniform += start.kind == StartKind::uniform ? 1 : 0;
  }
  EXPECT_GE(uniform, 198); // five of a uniform distribution are now and then close together
}

TEST(StartLatency, AScatterThatNeitherExplainsIsUndecided) {
  std::vector<double> offsets = fixed_start(9, 3);
  for (double& offset : offsets) {
    offset *= 20.0; // 40 us: twenty times u, a seventh of T / sqrt(12)
  }
  EXPECT_EQ(judge_start_latency(offsets, u_s, sample_s).kind, StartKind::undecided);
  for (double& offset : offsets) {
    offset *= 100.0; // several samples
  }
  EXPECT_EQ(judge_start_latency(offsets, u_s, sample_s).kind, StartKind::undecided);
}

TEST(StartLatency, OtherStepsTellWhereThisOneResolvesTooLittle) {
  for (const std::vector<double>& offsets : {fixed_start(2, 1), uniform_start(2, 1)}) {
    const StartLatency start = judge_start_latency(offsets, u_s, sample_s);
    EXPECT_EQ(start.kind_after(StartKind::fixed), StartKind::fixed);
    EXPECT_EQ(start.kind_after(StartKind::uniform), StartKind::uniform);
    EXPECT_EQ(start.kind_after(StartKind::undecided), StartKind::undecided);
  }
  const StartLatency noisy = judge_start_latency(uniform_start(5, 7), sample_s, sample_s);
  ASSERT_EQ(noisy.kind, StartKind::undecided);
  EXPECT_EQ(noisy.kind_after(StartKind::fixed), StartKind::fixed);
  EXPECT_EQ(noisy.kind_after(StartKind::uniform), StartKind::uniform);
}

TEST(StartLatency, OtherStepsDoNotHideAShotOfAnotherTrigger) {
  std::vector<double> offsets = fixed_start(5, 3);
  offsets[2] += 20.0 * u_s;
  const StartLatency outlier = judge_start_latency(offsets, u_s, sample_s);
  ASSERT_EQ(outlier.kind, StartKind::undecided);
  EXPECT_EQ(outlier.kind_after(StartKind::fixed), StartKind::undecided);
  offsets[2] += 10.0 * sample_s;
  EXPECT_EQ(judge_start_latency(offsets, u_s, sample_s).kind_after(StartKind::uniform),
            StartKind::undecided);
}

TEST(StartLatency, WhatAStepTellsItselfStands) {
  const StartLatency fixed = judge_start_latency(fixed_start(5, 1), u_s, sample_s);
  ASSERT_EQ(fixed.kind, StartKind::fixed);
  EXPECT_EQ(fixed.kind_after(StartKind::uniform), StartKind::fixed);
  EXPECT_EQ(fixed.kind_after(StartKind::undecided), StartKind::fixed);
}

TEST(StartLatency, TwoShotsOrNoSampleIntervalDecideNothing) {
  EXPECT_EQ(judge_start_latency(fixed_start(2, 1), u_s, sample_s).kind, StartKind::undecided);
  EXPECT_EQ(judge_start_latency(fixed_start(5, 1), u_s, 0.0).kind, StartKind::undecided);
}

TEST(StartLatency, NoiseAsWideAsTheSampleHidesTheDifference) {
  EXPECT_EQ(judge_start_latency(uniform_start(5, 7), sample_s, sample_s).kind,
            StartKind::undecided);
}

TEST(StartLatency, ShotsWithoutNoiseAreJudgedToo) {
  EXPECT_EQ(judge_start_latency(std::vector<double>(5, 1e-5), 0.0, sample_s).kind,
            StartKind::fixed);
}

} // namespace
} // namespace dyncal::analysis
