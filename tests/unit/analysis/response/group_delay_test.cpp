#include "analysis/response/group_delay.hpp"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

const std::vector<double> plan{10,   12.5, 16, 20,  25,  31.5, 40,  46.7, 50,
                               53.3, 63,   80, 100, 125, 160,  200, 250};

std::vector<PhasePoint> phases_of(double delay_s, double intercept_rad, double u_rad,
                                  const std::vector<double>& frequencies = plan,
                                  unsigned seed = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  std::vector<PhasePoint> points;
  for (const double f : frequencies) {
    points.push_back(
        {f,
         wrap_phase(intercept_rad - 2.0 * pi * f * delay_s + (seed ? u_rad * noise(random) : 0.0)),
         u_rad});
  }
  return points;
}

TEST(GroupDelay, FindsTheDelayOfThePaperAlthoughStepsComeNearHalfATurn) {
  for (const double delay : {0.0, 0.55e-3, 1.511e-3, 8.1e-3, -2e-3, 20e-3}) {
    const auto result = evaluate_group_delay(phases_of(delay, 0.0, 1e-4));
    ASSERT_TRUE(result.has_value()) << result.error().message;
    EXPECT_NEAR(result->delay_s, delay, 1e-12 * std::max(1e-3, std::abs(delay))) << delay;
    EXPECT_NEAR(result->intercept_rad, 0.0, 1e-12) << delay;
    EXPECT_FALSE(result->polarity_inverted);
    EXPECT_NEAR(result->unwrapped_rad.back(), -2.0 * pi * 250.0 * delay, 1e-11);
  }
}

TEST(GroupDelay, KeepsAnInvertedPolarityAsTheIntercept) {
  const auto result = evaluate_group_delay(phases_of(1.5111e-3, 3.14, 1e-4));
  ASSERT_TRUE(result.has_value());
  EXPECT_TRUE(result->polarity_inverted);
  EXPECT_NEAR(result->intercept_rad, 3.14, 1e-12);
  EXPECT_NEAR(result->delay_s, 1.5111e-3, 1e-14);
}

TEST(GroupDelay, FewPointsAreUnwrappedByTheSlopeBefore) {
  const auto result = evaluate_group_delay(phases_of(8.1e-3, 0.1, 1e-4, {10, 12.5, 40, 90}));
  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_NEAR(result->delay_s, 8.1e-3, 1e-13);
  EXPECT_NEAR(result->intercept_rad, 0.1, 1e-12);
}

TEST(GroupDelay, SaysSoWhenThePhaseCannotBeUnwrapped) {
  // Half a turn from the first to the second of few points: lead or delay is undecided.
  const auto result = evaluate_group_delay(phases_of(0.5 / 50.0, 0.0, 1e-3, {50, 100, 150}));
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::not_converged);
  EXPECT_NE(result.error().message.find("50 Hz to 100 Hz"), std::string::npos)
      << result.error().message;
}

// 30 ms and 5 ms have the same phases at multiples of 40 Hz.
TEST(GroupDelay, NamesTheOtherDelaysThatFit) {
  for (const double delay : {5e-3, 30e-3}) {
    const auto result = evaluate_group_delay(phases_of(delay, 0.0, 1e-4, {40, 80, 160}));
    ASSERT_TRUE(result.has_value()) << result.error().message;
    EXPECT_NEAR(result->delay_s, 5e-3, 1e-9);
    ASSERT_EQ(result->alternatives_s.size(), 1U);
    EXPECT_NEAR(result->alternatives_s[0], 30e-3, 1e-9);
  }
  EXPECT_EQ(evaluate_group_delay(phases_of(30e-3, 0.0, 1e-4))->alternatives_s.size(), 0U);
}

TEST(GroupDelay, FewFrequenciesThatTellItAreEnough) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> delay_s(0.2e-3, 4e-3);
  for (unsigned draw = 1; draw <= 100; ++draw) {
    const double delay = delay_s(random);
    for (const std::vector<double>& frequencies : {std::vector<double>{31.5, 40.0},
                                                   {12.5, 16.0, 80.0},
                                                   {12.5, 31.5, 63, 80, 125, 160, 200}}) {
      const auto result = evaluate_group_delay(phases_of(delay, 0.0, 1e-3, frequencies, draw));
      ASSERT_TRUE(result.has_value()) << result.error().message;
      EXPECT_NEAR(result->delay_s, delay, 5.0 * result->u_delay_s());
      EXPECT_TRUE(result->alternatives_s.empty()) << delay << " s, " << frequencies.size();
    }
  }
}

// From 10 to 80 Hz it makes more than half a turn: the nearest turn gives -7.7 ms and bends.
TEST(GroupDelay, TakesTheDelayThatFits) {
  const auto result = evaluate_group_delay(phases_of(8.1e-3, 0.0, 1e-4, {10, 80, 200}, 5));
  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_NEAR(result->delay_s, 8.1e-3, 5.0 * result->u_delay_s());
  EXPECT_LT(result->chi_squared, 11.0);
  EXPECT_TRUE(result->alternatives_s.empty());
  EXPECT_NEAR(result->unwrapped_rad.back(), -2.0 * pi * 200.0 * 8.1e-3, 1e-3);
}

TEST(GroupDelay, PhasesWithoutMeaningGiveNoDelay) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> anywhere(-pi, pi);
  std::vector<PhasePoint> points;
  for (const double f : plan) {
    points.push_back({f, anywhere(random), 0.3});
  }
  EXPECT_FALSE(evaluate_group_delay(points).has_value());
  for (PhasePoint& point : points) {
    point.u_phase_rad = 1.8;
  }
  EXPECT_EQ(evaluate_group_delay(points).error().code, ErrorCode::too_few_samples);
}

TEST(GroupDelay, AnUncertainPointFollowsTheLineAndDoesNotCount) {
  auto points = phases_of(8.1e-3, 0.0, 1e-4);
  points[5].phase_rad = wrap_phase(points[5].phase_rad + 2.0);
  points[5].u_phase_rad = 1.5;
  const auto result = evaluate_group_delay(points);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->delay_s, 8.1e-3, 1e-13);
  EXPECT_NEAR(result->unwrapped_rad[5], -2.0 * pi * points[5].frequency_hz * 8.1e-3 + 2.0, 1e-9);
}

TEST(GroupDelay, FollowsAResponseThatIsNoPureDelay) {
  // Second-order low pass at 300 Hz behind a delay of 1.5 ms.
  std::vector<PhasePoint> points;
  for (const double f : plan) {
    const double r = f / 300.0;
    points.push_back(
        {f, wrap_phase(-2.0 * pi * f * 1.5e-3 - std::atan2(1.2 * r, 1.0 - r * r)), 1e-3});
  }
  const auto result = evaluate_group_delay(points);
  ASSERT_TRUE(result.has_value()) << result.error().message;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = points[i].frequency_hz / 300.0;
    EXPECT_NEAR(result->unwrapped_rad[i],
                -2.0 * pi * points[i].frequency_hz * 1.5e-3 - std::atan2(1.2 * r, 1.0 - r * r),
                1e-9);
  }
  EXPECT_GT(result->chi_squared, 10.0 * result->degrees_of_freedom);
  EXPECT_GT(result->u_delay_s(),
            1e-6); // no straight line: more than the 0.3 us of the points alone
}

TEST(GroupDelay, ACommonDelayGoesInFullIntoTheUncertainty) {
  const auto alone = evaluate_group_delay(phases_of(8.1e-3, 0.0, 1e-4));
  const auto result =
      evaluate_group_delay(phases_of(8.1e-3, 0.0, 1e-4), {.delay_s = 1e-6, .phase_rad = 2e-3});
  ASSERT_TRUE(alone && result);
  EXPECT_NEAR(result->u_delay_s(), std::hypot(alone->u_delay_s(), 1e-6), 1e-15);
  EXPECT_NEAR(result->u_intercept_rad(), std::hypot(alone->u_intercept_rad(), 2e-3), 1e-12);
  const std::size_t n = plan.size();
  ASSERT_EQ(result->phase_covariance.size(), n * n);
  EXPECT_NEAR(result->phase_covariance[1], 4e-6 + 1e-12 * 4.0 * pi * pi * 10.0 * 12.5, 1e-15);
  EXPECT_NEAR(result->phase_covariance[0], 1e-8 + 4e-6 + 1e-12 * 4.0 * pi * pi * 100.0, 1e-15);
}

TEST(GroupDelay, CoversTheTruthInNineteenOfTwentyRuns) {
  const char* text = std::getenv("DYNCAL_COVERAGE_RUNS");
  const unsigned runs = text ? static_cast<unsigned>(std::stoul(text)) : 2000;
  std::mt19937 random(77);
  std::normal_distribution<double> noise;
  unsigned covered = 0;
  for (unsigned run = 1; run <= runs; ++run) {
    const double common_delay = 5e-7 * noise(random);
    const double common_phase = 1e-3 * noise(random);
    const auto points = phases_of(8.1e-3 + common_delay, common_phase, 5e-4, plan, run);
    const auto result = evaluate_group_delay(points, {.delay_s = 5e-7, .phase_rad = 1e-3});
    ASSERT_TRUE(result.has_value());
    covered += std::abs(result->delay_s - 8.1e-3) <= 2.0 * result->u_delay_s();
  }
  EXPECT_NEAR(static_cast<double>(covered) / runs, 0.9545, 0.014);
}

// What is known of the uncertainties, and what is drawn.
struct Known {
  double degrees_of_freedom = infinite_degrees_of_freedom; // of all phases together
  bool each_by_itself = false;                             // estimated anew at every frequency
  double understated = 1.0;                                // by how much u is too small
  double common_s = 0.0;
  double common_freedom = infinite_degrees_of_freedom;
};

class GroupDelayOfKnownUncertainty : public testing::TestWithParam<Known> {
protected:
  // An estimate of the standard deviation 1.
  double estimated(double degrees_of_freedom) {
    if (std::isinf(degrees_of_freedom)) {
      return 1.0;
    }
    std::chi_squared_distribution<double> squares(degrees_of_freedom);
    return std::sqrt(squares(random_) / degrees_of_freedom);
  }

  Expected<GroupDelay> draw(const Known& known, double delay_s) {
    constexpr double sd_rad = 5e-4;
    std::normal_distribution<double> normal;
    const double k = coverage_factor(known.degrees_of_freedom);
    const double shared = estimated(known.degrees_of_freedom);
    const double late_s = delay_s + known.common_s * normal(random_);
    std::vector<PhasePoint> points;
    for (const double f : {10.0, 16.0, 20.0, 31.5, 40.0, 63.0, 80.0, 100.0, 125.0, 160.0}) {
      const double u =
          sd_rad * (known.each_by_itself ? estimated(known.degrees_of_freedom) : shared);
      const double noise = known.understated * sd_rad * normal(random_);
      points.push_back({f, wrap_phase(noise - 2.0 * pi * f * late_s), 0.5 * k * u,
                        KnownTo{k, known.degrees_of_freedom}});
    }
    const double k_common = coverage_factor(known.common_freedom);
    const double u_common = known.common_s * estimated(known.common_freedom);
    return evaluate_group_delay(points, {.delay_s = 0.5 * k_common * u_common,
                                         .delay_known = {k_common, known.common_freedom}});
  }

private:
  std::mt19937_64 random_{31};
};

// 500 draws: chance moves 95.45 % by two and a half standard deviations of 0.9 %.
TEST_P(GroupDelayOfKnownUncertainty, CoversAndIsNotMuchTooWide) {
  constexpr int draws = 500;
  constexpr double delay_s = 2e-3;
  int covered = 0;
  double squares = 0.0, expanded = 0.0;
  for (int i = 0; i < draws; ++i) {
    const auto result = draw(GetParam(), delay_s);
    ASSERT_TRUE(result.has_value()) << result.error().message;
    const double error_s = result->delay_s - delay_s;
    covered += std::abs(error_s) <= result->of_delay.expanded() ? 1 : 0;
    squares += error_s * error_s / draws;
    expanded += result->of_delay.expanded() / draws;
    EXPECT_NEAR(2.0 * result->u_delay_s(), result->of_delay.expanded(), 1e-15);
  }
  EXPECT_GE(covered, 0.93 * draws);
  EXPECT_LE(covered, 0.98 * draws);
  EXPECT_GT(expanded / (2.0 * std::sqrt(squares)), 0.9);
  EXPECT_LT(expanded / (2.0 * std::sqrt(squares)), 1.3);
}

INSTANTIATE_TEST_SUITE_P(WellAndBarely, GroupDelayOfKnownUncertainty,
                         testing::Values(Known{}, Known{.degrees_of_freedom = 8.0},
                                         Known{.degrees_of_freedom = 14.0, .each_by_itself = true},
                                         Known{.understated = 4.0},
                                         Known{.common_s = 1e-6, .common_freedom = 8.0},
                                         Known{.degrees_of_freedom = 8.0, .common_s = 1e-6}));

TEST(GroupDelay, CombinesTheDegreesOfFreedomOfItsParts) {
  const auto known = evaluate_group_delay(phases_of(2e-3, 0.0, 1e-4));
  ASSERT_TRUE(known.has_value());
  EXPECT_EQ(known->of_delay.k, 2.0);
  EXPECT_EQ(known->of_delay.degrees_of_freedom, infinite_degrees_of_freedom);
  auto points = phases_of(2e-3, 0.0, 1e-4);
  for (PhasePoint& point : points) {
    point.known = {coverage_factor(6.0), 6.0};
  }
  const auto few = evaluate_group_delay(points);
  ASSERT_TRUE(few.has_value());
  EXPECT_NEAR(few->of_delay.degrees_of_freedom, 6.0, 1e-9);
  EXPECT_NEAR(few->of_intercept.degrees_of_freedom, 6.0, 1e-9);
  EXPECT_NEAR(few->of_delay.k, coverage_factor(6.0), 1e-9);
  EXPECT_NEAR(few->u_delay_s(), known->u_delay_s(), 1e-15);
  const auto beside = evaluate_group_delay(points, {.delay_s = 3.0 * few->of_delay.u});
  ASSERT_TRUE(beside.has_value());
  EXPECT_NEAR(beside->of_delay.degrees_of_freedom, 600.0, 1e-6);
  EXPECT_NEAR(beside->of_delay.u, few->of_delay.u * std::sqrt(10.0), 1e-15);
}

TEST(GroupDelay, RefusesWhatMakesNoSense) {
  EXPECT_EQ(evaluate_group_delay({}).error().code, ErrorCode::too_few_samples);
  EXPECT_EQ(evaluate_group_delay(phases_of(1e-3, 0.0, 1e-3, {20, 10})).error().code,
            ErrorCode::invalid_argument);
  EXPECT_EQ(evaluate_group_delay(phases_of(1e-3, 0.0, 0.0)).error().code,
            ErrorCode::invalid_argument);
}

} // namespace
} // namespace dyncal::analysis
