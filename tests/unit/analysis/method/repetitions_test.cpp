#include "analysis/method/repetitions.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

std::complex<double> h_of(double magnitude, double phase) {
  return std::polar(magnitude, phase);
}

TEST(Repetitions, MeanIsCircularAcrossTheCut) {
  const std::array repetitions{Repetition{.h = h_of(1.0, 3.1)}, Repetition{.h = h_of(1.0, -3.1)}};
  const auto mean = mean_of_repetitions(repetitions);
  ASSERT_TRUE(mean.has_value());
  EXPECT_NEAR(std::abs(mean->phase_rad), std::numbers::pi, 1e-12);
  EXPECT_NEAR(mean->magnitude, 1.0, 1e-12); // scatter of the phase does not shorten it
}

TEST(Repetitions, OneRepetitionKeepsItsOwnUncertainty) {
  const std::array repetitions{Repetition{h_of(2.0, 0.5), 3e-4, 4e-4, 4e-4, 3e-4}};
  const auto mean = mean_of_repetitions(repetitions);
  ASSERT_TRUE(mean.has_value());
  EXPECT_NEAR(mean->u_magnitude, 2.0 * 5e-4, 1e-12);
  EXPECT_NEAR(mean->u_phase_rad, 5e-4, 1e-12);
  EXPECT_NEAR(mean->u_independent_phase_rad, 4e-4, 1e-12);
  EXPECT_EQ(mean->scatter_phase_rad, 0.0);
  EXPECT_NEAR(mean->phase.k, 2.0, 1e-12);
}

TEST(Repetitions, OneRepetitionHasTheDegreesOfFreedomOfItsBudget) {
  const std::array budget{Contribution{.kind = ContributionKind::shots,
                                       .degrees_of_freedom = 4.0,
                                       .u_magnitude_rel = 3e-4,
                                       .u_phase_rad = 1e-4},
                          Contribution{.kind = ContributionKind::reference,
                                       .u_magnitude_rel = 4e-4,
                                       .u_phase_rad = 2e-3}};
  const auto mean = mean_of_repetitions(std::array{make_repetition(h_of(2.0, 0.1), budget)});
  ASSERT_TRUE(mean.has_value());
  EXPECT_NEAR(mean->magnitude_rel.u, 5e-4, 1e-12);
  EXPECT_NEAR(mean->magnitude_rel.degrees_of_freedom, 4.0 * std::pow(5.0 / 3.0, 4), 1e-9);
  EXPECT_NEAR(mean->magnitude_rel.k, coverage_factor(4.0 * std::pow(5.0 / 3.0, 4)), 1e-9);
  EXPECT_NEAR(mean->u_magnitude, 2.0 * 0.5 * mean->magnitude_rel.k * 5e-4, 1e-12);
  EXPECT_NEAR(mean->phase.k, 2.0, 1e-3);
}

TEST(Repetitions, ThreeThatScatterNeedStudentsFactor) {
  const std::array repetitions{Repetition{.h = h_of(1.0, -1e-3)}, Repetition{.h = h_of(1.0, 0.0)},
                               Repetition{.h = h_of(1.0, 1e-3)}};
  const auto mean = mean_of_repetitions(repetitions);
  ASSERT_TRUE(mean.has_value());
  EXPECT_NEAR(mean->scatter_phase_rad, 1e-3, 1e-9);
  EXPECT_NEAR(mean->phase.u, 1e-3 / std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(mean->phase.degrees_of_freedom, 2.0, 1e-9);
  EXPECT_NEAR(mean->phase.k, 4.5265, 1e-3);
  EXPECT_NEAR(mean->u_phase_rad, 0.5 * 4.5265 * 1e-3 / std::sqrt(3.0), 1e-6);
}

TEST(Repetitions, CommonPartsDoNotAverageOut) {
  std::vector<Repetition> repetitions(100, Repetition{h_of(1.0, 0.3), 1e-4, 1e-4, 1e-3, 2e-3});
  const auto mean = mean_of_repetitions(repetitions);
  ASSERT_TRUE(mean.has_value());
  // A hundred runs without scatter leave little room for any.
  EXPECT_NEAR(mean->u_magnitude, std::hypot(1e-5, 1e-3), 1e-9);
  EXPECT_NEAR(mean->u_phase_rad, std::hypot(1e-5, 2e-3), 1e-9);
}

TEST(Repetitions, ABudgetIsDividedByWhatRepeats) {
  const std::array budget{
      Contribution{
          .kind = ContributionKind::fit_noise, .u_magnitude_rel = 3e-4, .u_phase_rad = 1e-4},
      Contribution{.kind = ContributionKind::structure, .u_magnitude_rel = 4e-4},
      Contribution{
          .kind = ContributionKind::reference, .u_magnitude_rel = 1e-3, .u_phase_rad = 2e-3}};
  const Repetition repetition = make_repetition(h_of(1.0, 0.0), budget);
  EXPECT_DOUBLE_EQ(repetition.u_random_magnitude_rel, 5e-4);
  EXPECT_DOUBLE_EQ(repetition.u_random_phase_rad, 1e-4);
  EXPECT_DOUBLE_EQ(repetition.u_common_magnitude_rel, 1e-3);
  EXPECT_DOUBLE_EQ(repetition.u_common_phase_rad, 2e-3);
}

// Stamp noise scatters anew in every repetition, but shortens the amplitude in all of them alike.
TEST(Repetitions, WhatLastsOfADrawnRowIsCommon) {
  const std::array budget{Contribution{.kind = ContributionKind::stamp_jitter,
                                       .u_magnitude_rel = 5e-4,
                                       .u_phase_rad = 7e-4,
                                       .u_lasting_magnitude_rel = 4e-4}};
  const Repetition repetition = make_repetition(h_of(1.0, 0.0), budget);
  EXPECT_DOUBLE_EQ(repetition.u_random_magnitude_rel, 3e-4);
  EXPECT_DOUBLE_EQ(repetition.u_common_magnitude_rel, 4e-4);
  EXPECT_DOUBLE_EQ(repetition.u_random_phase_rad, 7e-4);
  EXPECT_EQ(repetition.u_common_phase_rad, 0.0);
}

// A bound of hum lengthens nothing: three singles of 1.0088 were reported as 1.0006.
TEST(Repetitions, OnlyNoiseOfThePhasorIsTakenOffTheirLengths) {
  std::vector<Repetition> repetitions;
  for (int i = 0; i < 3; ++i) {
    const std::array budget{
        Contribution{
            .kind = ContributionKind::fit_noise, .u_magnitude_rel = 2e-4, .u_phase_rad = 2e-4},
        Contribution{
            .kind = ContributionKind::mains_hum, .u_magnitude_rel = 0.15, .u_phase_rad = 0.15}};
    repetitions.push_back(make_repetition(h_of(1.0088, 0.1), budget));
    EXPECT_NEAR(repetitions.back().u_not_noise_magnitude_rel, 0.15, 1e-12);
  }
  const auto mean = mean_of_repetitions(repetitions);
  ASSERT_TRUE(mean.has_value());
  EXPECT_NEAR(mean->magnitude, 1.0088, 1e-12);
  for (Repetition& repetition : repetitions) {
    repetition.u_not_noise_magnitude_rel = 0.0; // noise of 15 % lengthens by 1 %
  }
  EXPECT_NEAR(mean_of_repetitions(repetitions)->magnitude, 1.0088 * (1.0 - 0.5 * 0.15 * 0.15),
              1e-3);
}

TEST(Repetitions, NoiseHasNoPhase) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1e-3);
  std::vector<Repetition> repetitions;
  for (int i = 0; i < 3; ++i) {
    repetitions.push_back({{noise(random), noise(random)}, 0.7, 1.0, 1e-3, 1e-3});
  }
  const auto mean = mean_of_repetitions(repetitions);
  ASSERT_TRUE(mean.has_value());
  EXPECT_LE(mean->magnitude, 4.0 * mean->u_magnitude);
  EXPECT_GT(mean->u_phase_rad, 0.3);
}

TEST(Repetitions, OneThatPointsTheOtherWayIsSeen) {
  for (const std::size_t others : {1U, 2U}) {
    std::vector<Repetition> repetitions(others, Repetition{h_of(1.0, 0.3), 1e-3, 1e-3, 1e-3, 1e-3});
    repetitions.push_back({h_of(1.0, 0.3 - std::numbers::pi), 1e-3, 1e-3, 1e-3, 1e-3});
    const auto mean = mean_of_repetitions(repetitions);
    ASSERT_TRUE(mean.has_value());
    EXPECT_TRUE(mean->polarity_differs);
    EXPECT_GT(mean->u_phase_rad, 1.0);
    EXPECT_GT(mean->scatter_phase_rad, 1.0);
  }
  // Weak phases and such as only scatter do not.
  const std::array weak{Repetition{h_of(1.0, 0.0), 0.5, 0.6, 0.0, 0.0},
                        Repetition{h_of(1.0, 3.1), 0.5, 0.6, 0.0, 0.0}};
  EXPECT_FALSE(mean_of_repetitions(weak)->polarity_differs);
  const std::array scattered{Repetition{h_of(1.0, 0.0), 1e-3, 1e-3, 0.0, 0.0},
                             Repetition{h_of(1.0, 1.2), 1e-3, 1e-3, 0.0, 0.0}};
  EXPECT_FALSE(mean_of_repetitions(scattered)->polarity_differs);
}

TEST(Repetitions, RefusesNothingAndWhatIsNoNumber) {
  EXPECT_EQ(mean_of_repetitions({}).error().code, ErrorCode::invalid_argument);
  const std::array repetitions{Repetition{.h = {std::nan(""), 0.0}}};
  EXPECT_EQ(mean_of_repetitions(repetitions).error().code, ErrorCode::not_finite);
}

// Between-run scatter three times the noise of the fits, n = 3, and a common part as large as the
// noise: 96.6 % of 4000 runs are covered.
TEST(Repetitions, CoversTheTruthInNineteenOfTwentyRunsOfThree) {
  const char* text = std::getenv("DYNCAL_COVERAGE_RUNS");
  const int runs = text ? std::stoi(text) : 4000;
  std::mt19937_64 random(12);
  std::normal_distribution<double> noise;
  int magnitude_covered = 0, phase_covered = 0;
  for (int run = 0; run < runs; ++run) {
    const double common_magnitude = 1e-3 * noise(random), common_phase = 1e-3 * noise(random);
    std::vector<Repetition> repetitions;
    for (int i = 0; i < 3; ++i) {
      const double sd = std::hypot(1e-3, 3e-3);
      repetitions.push_back({h_of(0.95 * (1.0 + common_magnitude + sd * noise(random)),
                                  2.0 + common_phase + sd * noise(random)),
                             1e-3, 1e-3, 1e-3, 1e-3});
    }
    const auto mean = mean_of_repetitions(repetitions);
    ASSERT_TRUE(mean.has_value());
    magnitude_covered += std::abs(mean->magnitude - 0.95) <= 2.0 * mean->u_magnitude;
    phase_covered += std::abs(wrap_phase(mean->phase_rad - 2.0)) <= 2.0 * mean->u_phase_rad;
  }
  // Three runs of one frequency do not rule out that they scatter more: 97 % where it is 3 u.
  for (const int covered : {magnitude_covered, phase_covered}) {
    EXPECT_GT(static_cast<double>(covered) / runs, two_sigma_probability - 0.01);
    EXPECT_LT(static_cast<double>(covered) / runs, two_sigma_probability + 0.025);
  }
}

// Shots of a sensor that samples freely: each starts anywhere within one sample interval, so that
// its phase is uniform over 2 pi f / fs. The length of their mean phasor would be sinc(f / fs) of
// the truth, 6.5 % short at 200 Hz of 1 kS/s.
struct FreeShots {
  int shots = 20;
  double width_rad = 0.4 * std::numbers::pi; // 200 Hz of 1 kS/s
  double snr = 1000.0;                       // of one shot
};

struct FreeCoverage {
  double magnitude = 0.0, phase = 0.0, bias_rel = 0.0;
};

FreeCoverage free_coverage(const FreeShots& free, int runs, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.9 / free.snr);
  std::uniform_real_distribution<double> start(-0.5 * free.width_rad, 0.5 * free.width_rad);
  FreeCoverage result;
  for (int run = 0; run < runs; ++run) {
    std::vector<Repetition> shots;
    for (int j = 0; j < free.shots; ++j) {
      const std::complex<double> h =
          h_of(0.9, 3.0 + start(random)) + std::complex<double>(noise(random), noise(random));
      const double snr = std::abs(h) * free.snr / 0.9;
      shots.push_back({h, 1.0 / snr, phase_standard_uncertainty(snr), 0.0, 0.0});
    }
    const auto mean = mean_of_repetitions(shots);
    if (!mean) {
      ADD_FAILURE() << mean.error().message;
      return result;
    }
    result.magnitude += std::abs(mean->magnitude - 0.9) <= 2.0 * mean->u_magnitude;
    result.phase += std::abs(wrap_phase(mean->phase_rad - 3.0)) <= 2.0 * mean->u_phase_rad;
    result.bias_rel += mean->magnitude / 0.9 - 1.0;
  }
  return {result.magnitude / runs, result.phase / runs, result.bias_rel / runs};
}

TEST(Repetitions, ShotsThatStartAnywhereKeepTheirMagnitude) {
  const char* text = std::getenv("DYNCAL_COVERAGE_RUNS");
  const int runs = text ? std::stoi(text) : 600;
  const double slack = 3.0 * std::sqrt(0.0455 * 0.9545 / runs);
  for (const int shots : {20, 200}) {
    for (const double snr : {3.0, 10.0, 1000.0}) {
      const FreeCoverage seen =
          free_coverage({.shots = shots, .snr = snr}, shots > 100 ? runs / 4 : runs, 31);
      const double spread = 1.0 / snr / std::sqrt(1.0 * shots * runs / (shots > 100 ? 4 : 1));
      EXPECT_NEAR(seen.bias_rel, 0.0, 4.0 * spread + 2e-3 / (snr * snr)) << shots << ", " << snr;
      const double allowed = 0.02 + (shots > 100 ? 2.0 : 1.0) * slack;
      EXPECT_NEAR(seen.magnitude, 0.9545, allowed) << shots << " shots, SNR " << snr;
      EXPECT_NEAR(seen.phase, 0.9545, allowed) << shots << " shots, SNR " << snr;
    }
  }
}

} // namespace
} // namespace dyncal::analysis
