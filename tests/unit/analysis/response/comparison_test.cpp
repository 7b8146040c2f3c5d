#include "analysis/response/comparison.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(Comparison, NormalisedErrorIsTheDifferenceOverItsExpandedUncertainty) {
  EXPECT_NEAR(*normalised_error(1.010, 3e-3, 1.000, 4e-3), 1.0, 1e-12);
  EXPECT_NEAR(*normalised_error(1.000, 3e-3, 1.010, 4e-3), -1.0, 1e-12);
}

TEST(Comparison, WhatBothHaveInCommonDoesNotExcuseADifference) {
  EXPECT_NEAR(*normalised_error(1.01, 5e-3, 1.0, 5e-3, 16e-6),
              0.01 / (2.0 * std::sqrt(50e-6 - 32e-6)), 1e-12);
  EXPECT_FALSE(normalised_error(1.01, 5e-3, 1.0, 5e-3, 25e-6).has_value());
}

TEST(Comparison, PhasesAreComparedAcrossTheCut) {
  const auto result = compare_transfer({1.0, 1e-3, 3.1410, 1e-3}, {1.0, 1e-3, -3.1410, 1e-3});
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->en_phase, (6.282 - 2.0 * 3.14159265358979) / (2.0 * std::sqrt(2e-6)), 1e-9);
  EXPECT_EQ(result->en_magnitude, 0.0);
  EXPECT_NEAR(result->probability, std::exp(-2.0 * result->en_phase * result->en_phase), 1e-12);
}

TEST(Comparison, NeedsUncertainties) {
  EXPECT_FALSE(compare_transfer({1.0, 0.0, 0.0, 1e-3}, {1.0, 0.0, 0.0, 1e-3}).has_value());
}

} // namespace
} // namespace dyncal::analysis
