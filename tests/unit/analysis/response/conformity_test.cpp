#include "analysis/response/conformity.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

using enum ConformityStatement;
constexpr ToleranceLimits limits{-5.0, 5.0};
constexpr CombinedUncertainty of_value{.u = 0.5}; // U = 1

ConformityStatement said(double value, DecisionRule rule, double factor = 1.0) {
  const auto decided = decide_conformity(value, of_value, limits, rule, factor);
  return decided ? decided->statement : undecided;
}

TEST(Conformity, SimpleAcceptanceTakesTheLimitItself) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(said(sign * 4.9, DecisionRule::simple_acceptance), pass);
    EXPECT_EQ(said(sign * 5.0, DecisionRule::simple_acceptance), pass);
    EXPECT_EQ(said(sign * 5.0001, DecisionRule::simple_acceptance), fail);
  }
  // 5.000000000000004: rounding of 100 (1.05 - 1) does not decide.
  EXPECT_EQ(said(100.0 * (1.05 - 1.0), DecisionRule::simple_acceptance), pass);
}

TEST(Conformity, GuardBandMovesTheLimitByU) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(said(sign * 4.0, DecisionRule::guard_band), pass);
    EXPECT_EQ(said(sign * 4.001, DecisionRule::guard_band), fail);
    EXPECT_EQ(said(sign * 4.499, DecisionRule::guard_band, 0.5), pass);
    EXPECT_EQ(said(sign * 3.001, DecisionRule::guard_band, 2.0), fail);
  }
}

TEST(Conformity, NonBinaryStatementsMeetWhereTheBandsEnd) {
  constexpr auto rule = DecisionRule::guard_band_non_binary;
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(said(sign * 4.0, rule), pass);
    EXPECT_EQ(said(sign * 4.001, rule), conditional_pass);
    EXPECT_EQ(said(sign * 5.0, rule), conditional_pass);
    EXPECT_EQ(said(sign * 5.001, rule), conditional_fail);
    EXPECT_EQ(said(sign * 6.0, rule), conditional_fail);
    EXPECT_EQ(said(sign * 6.001, rule), fail);
  }
}

TEST(Conformity, NothingPassesWhereTheGuardBandsMeet) {
  const CombinedUncertainty wide{.u = 2.6};
  const auto decided = decide_conformity(0.0, wide, limits, DecisionRule::guard_band);
  ASSERT_TRUE(decided);
  EXPECT_EQ(decided->statement, fail);
  EXPECT_GT(decided->probability, 0.9); // as ILAC-G8 has it all the same
  const CombinedUncertainty just{.u = 2.5};
  EXPECT_EQ(decide_conformity(0.0, just, limits, DecisionRule::guard_band)->statement, pass);
}

TEST(Conformity, ProbabilityIsThatOfTheDistribution) {
  const auto probability = [](double value, const CombinedUncertainty& of) {
    return decide_conformity(value, of, limits, DecisionRule::simple_acceptance)->probability;
  };
  EXPECT_NEAR(probability(5.0, of_value), 0.5, 1e-9);
  EXPECT_NEAR(probability(4.0, of_value), 0.977249868, 1e-9); // Phi(2)
  EXPECT_NEAR(probability(6.0, of_value), 0.022750132, 1e-9);
  EXPECT_NEAR(probability(0.0, {.u = 2.5}), 0.954499736, 1e-9); // both limits
  // Four degrees of freedom: the interval of 95.45 % is U all the same.
  const double k = coverage_factor(4.0);
  EXPECT_NEAR(probability(4.0, {.u = 1.0 / k, .degrees_of_freedom = 4.0, .k = k}), 0.977249868,
              1e-5); // and what is beyond the other limit
  const ToleranceLimits above{-std::numeric_limits<double>::infinity(), 5.0};
  EXPECT_NEAR(decide_conformity(4.0, of_value, above, DecisionRule::simple_acceptance)->probability,
              0.977249868, 1e-9);
}

TEST(Conformity, NeedsValueAndU) {
  const double nan = std::nan("");
  constexpr auto rule = DecisionRule::simple_acceptance;
  EXPECT_FALSE(decide_conformity(nan, of_value, limits, rule));
  EXPECT_FALSE(decide_conformity(0.0, {.u = 0.0}, limits, rule));
  EXPECT_FALSE(decide_conformity(0.0, {.u = nan}, limits, rule));
  EXPECT_FALSE(decide_conformity(0.0, of_value, {5.0, 5.0}, rule));
}

// How many of 200 draws with this true value pass.
int passes_of_200(double truth, DecisionRule rule, unsigned seed) {
  std::mt19937 bits(seed);
  std::normal_distribution<double> noise(0.0, of_value.u);
  int passes = 0;
  for (int draw = 0; draw < 200; ++draw) {
    passes += said(truth + noise(bits), rule) == pass ? 1 : 0;
  }
  return passes;
}

// Bounds of a binomial of 200 that are left once in a thousand.
TEST(Conformity, ErrorRatesAreThoseOfTheRule) {
  for (const double sign : {-1.0, 1.0}) {
    const int at_limit = passes_of_200(sign * 5.0, DecisionRule::simple_acceptance, 7);
    RecordProperty("simple_at_limit", at_limit);
    RecordProperty("guard_band_at_limit", passes_of_200(sign * 5.0, DecisionRule::guard_band, 11));
    EXPECT_GE(at_limit, 77) << "of 100 +- 23";
    EXPECT_LE(at_limit, 123) << "of 100 +- 23";
    for (const auto rule : {DecisionRule::guard_band, DecisionRule::guard_band_non_binary}) {
      EXPECT_LE(passes_of_200(sign * 5.0, rule, 11), 14) << "false accept above 2.5 %";
      // The producer's risk at the acceptance limit is the other half of the same band.
      const int at_acceptance_limit = passes_of_200(sign * 4.0, rule, 13);
      EXPECT_GE(at_acceptance_limit, 77);
      EXPECT_LE(at_acceptance_limit, 123);
      EXPECT_GE(passes_of_200(sign * 3.0, rule, 17), 186) << "false reject above 2.5 %";
    }
  }
}

} // namespace
} // namespace dyncal::analysis
