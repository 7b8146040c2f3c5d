#include "analysis/method/start_latency.hpp"

#include <algorithm>
#include <cmath>
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
  int fixed = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const StartLatency start = judge_start_latency(fixed_start(5, seed), u_s, sample_s);
    EXPECT_NE(start.kind, StartKind::uniform) << seed;
    fixed += start.kind == StartKind::fixed ? 1 : 0;
  }
  EXPECT_GE(fixed, 396);
}

TEST(StartLatency, ShotsSpreadOverOneSampleComeFromASensorThatRunsFree) {
  int uniform = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const StartLatency start = judge_start_latency(uniform_start(5, seed), u_s, sample_s);
    EXPECT_NE(start.kind, StartKind::fixed) << seed;
    uniform += start.kind == StartKind::uniform ? 1 : 0;
  }
  EXPECT_GE(uniform, 180); // five of a uniform distribution are now and then close together
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

// What scatter hides: the mean of the latency, of which the shots show nothing.
template <class Draw>
void expect_covered(std::size_t shots, Draw latency_of, const char* what) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, u_s);
  int wrong = 0;
  constexpr int runs = 400;
  constexpr int most = 31; // of a probability of 4.55 %: more only once in a thousand
  for (int run = 0; run < runs; ++run) {
    std::vector<double> offsets(shots);
    double mean = 0.0;
    for (double& offset : offsets) {
      offset = latency_of(random) + noise(random);
      mean += offset / static_cast<double>(shots);
    }
    const StartLatency start = judge_start_latency(offsets, u_s, sample_s);
    const double scatter = std::max(u_s, start.scatter_s) / std::sqrt(static_cast<double>(shots));
    const bool covered =
        std::abs(mean - start.latency_s) <= 2.0 * std::hypot(start.u_latency_s, scatter);
    wrong += covered ? 0 : 1;
  }
  EXPECT_LE(wrong, most) << what;
}

TEST(StartLatency, ItsUncertaintyHoldsTheMeanOfWhateverScatters) {
  for (const std::size_t shots : {5U, 12U}) {
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
      std::uniform_real_distribution<double> start(0.0, part * sample_s);
      expect_covered(shots, start, "within a part of a sample");
    }
    std::exponential_distribution<double> wait(1.0 / 50e-6);
    expect_covered(shots, wait, "waiting");
    std::normal_distribution<double> jitter(0.0, 50e-6);
    expect_covered(shots, jitter, "jitter");
  }
}

TEST(StartLatency, AQuarterOfASampleIsNotTakenForAWholeOne) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> start(0.0, 0.25 * sample_s);
  for (int run = 0; run < 100; ++run) {
    std::vector<double> offsets(12);
    for (double& offset : offsets) {
      offset = start(random);
    }
    EXPECT_EQ(judge_start_latency(offsets, u_s, sample_s).kind, StartKind::undecided);
  }
}

TEST(StartLatency, AFixedStartCostsLittle) {
  std::vector<double> parts;
  for (unsigned seed = 1; seed <= 201; ++seed) {
    const StartLatency start = judge_start_latency(fixed_start(12, seed), u_s, sample_s);
    EXPECT_EQ(start.latency_s, 0.0);
    parts.push_back(start.u_latency_s / (u_s / std::sqrt(12.0)));
  }
  std::nth_element(parts.begin(), parts.begin() + 100, parts.end());
  EXPECT_LT(parts[100], 0.85); // a third more of u, at most
}

TEST(StartLatency, OtherStepsTellWhereThisOneResolvesTooLittle) {
  const std::vector<double> two{0.0, 0.4 * sample_s};
  EXPECT_EQ(judge_start_latency(two, u_s, sample_s, StartKind::uniform).kind, StartKind::uniform);
  EXPECT_EQ(judge_start_latency(two, u_s, sample_s).kind, StartKind::undecided);
  EXPECT_EQ(judge_start_latency(fixed_start(2, 1), u_s, sample_s, StartKind::fixed).kind,
            StartKind::fixed);
  const std::vector<double> noisy = uniform_start(5, 7);
  ASSERT_EQ(judge_start_latency(noisy, sample_s, sample_s).kind, StartKind::undecided);
  for (const StartKind kind : {StartKind::fixed, StartKind::uniform}) {
    EXPECT_EQ(judge_start_latency(noisy, sample_s, sample_s, kind).kind, kind);
  }
}

TEST(StartLatency, OtherStepsDoNotHideAShotOfAnotherTrigger) {
  std::vector<double> offsets = fixed_start(5, 3);
  offsets[2] += 20.0 * u_s;
  EXPECT_EQ(judge_start_latency(offsets, u_s, sample_s, StartKind::fixed).kind,
            StartKind::undecided);
  offsets[2] += 10.0 * sample_s;
  EXPECT_EQ(judge_start_latency(offsets, u_s, sample_s, StartKind::uniform).kind,
            StartKind::undecided);
}

TEST(StartLatency, WhatAStepTellsItselfStands) {
  EXPECT_EQ(judge_start_latency(fixed_start(5, 1), u_s, sample_s, StartKind::uniform).kind,
            StartKind::fixed);
  EXPECT_EQ(judge_start_latency(uniform_start(12, 1), u_s, sample_s, StartKind::fixed).kind,
            StartKind::uniform);
}

TEST(StartLatency, TwoShotsOrNoSampleIntervalDecideNothing) {
  EXPECT_EQ(judge_start_latency(fixed_start(2, 1), u_s, sample_s).kind, StartKind::undecided);
  EXPECT_EQ(judge_start_latency(fixed_start(5, 1), u_s, 0.0).kind, StartKind::undecided);
}

TEST(StartLatency, OneShotLeavesBothWaysInItsUncertainty) {
  const StartLatency start = judge_start_latency(std::vector<double>{0.0}, u_s, sample_s);
  EXPECT_EQ(start.kind, StartKind::undecided);
  EXPECT_GT(2.0 * start.u_latency_s, 0.5 * sample_s);
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
