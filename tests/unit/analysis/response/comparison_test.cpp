#include "analysis/response/comparison.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// k = 2.
CombinedUncertainty well_known(double u) {
  return {.u = u};
}

TEST(Comparison, NormalisedErrorIsTheDifferenceOverItsExpandedUncertainty) {
  const auto difference = difference_of(1.010, well_known(3e-3), 1.000, well_known(4e-3));
  ASSERT_TRUE(difference.has_value());
  EXPECT_NEAR(difference->normalised_error(), 1.0, 1e-12);
  EXPECT_NEAR(difference->of_value.u, 5e-3, 1e-15);
  EXPECT_NEAR(difference->of_value.k, 2.0, 1e-12);
  EXPECT_NEAR(difference_of(1.000, well_known(3e-3), 1.010, well_known(4e-3))->normalised_error(),
              -1.0, 1e-12);
}

// Two repetitions beside a well-known value: U of the difference is that of the weak one.
TEST(Comparison, FewDegreesOfFreedomWidenTheDifference) {
  const CombinedUncertainty weak{1e-3, 1.0, coverage_factor(1.0)};
  const auto difference = difference_of(1.0, weak, 1.01, well_known(1e-4));
  ASSERT_TRUE(difference.has_value());
  EXPECT_NEAR(difference->of_value.expanded(), std::hypot(weak.expanded(), 2e-4), 1e-12);
  EXPECT_NEAR(difference->of_value.degrees_of_freedom, std::pow(1.01, 2), 1e-9);
  EXPECT_LT(std::abs(difference->normalised_error()), 1.0);
  EXPECT_GT(0.01 / (2.0 * difference->of_value.u), 1.0); // twice u would have called it another
}

TEST(Comparison, WhatBothHaveInCommonDoesNotExcuseADifference) {
  const auto difference = difference_of(1.01, well_known(5e-3), 1.0, well_known(5e-3), 16e-6);
  ASSERT_TRUE(difference.has_value());
  EXPECT_NEAR(difference->normalised_error(), 0.01 / (2.0 * std::sqrt(50e-6 - 32e-6)), 1e-12);
  EXPECT_FALSE(difference_of(1.01, well_known(5e-3), 1.0, well_known(5e-3), 25e-6).has_value());
}

TEST(Comparison, PhasesAreComparedAcrossTheCut) {
  const auto result = compare_transfer({1.0, well_known(1e-3), 3.1410, well_known(1e-3)},
                                       {1.0, well_known(1e-3), -3.1410, well_known(1e-3)});
  ASSERT_TRUE(result.has_value());
  const double en_phase = result->phase.normalised_error();
  EXPECT_NEAR(en_phase, (6.282 - 2.0 * 3.14159265358979) / (2.0 * std::sqrt(2e-6)), 1e-9);
  EXPECT_EQ(result->magnitude.normalised_error(), 0.0);
  EXPECT_NEAR(result->probability, std::exp(-2.0 * en_phase * en_phase), 1e-12);
}

TEST(Comparison, NeedsUncertainties) {
  const ComparedResult unknown{1.0, well_known(0.0), 0.0, well_known(1e-3)};
  EXPECT_FALSE(compare_transfer(unknown, unknown).has_value());
}

} // namespace
} // namespace dyncal::analysis
