#include "services/views/report/expanded_uncertainty.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

using analysis::ContributionKind;

TEST(ExpandedUncertainty, OfAPointFollowsTheDegreesOfFreedomOfItsBudget) {
  StepResult result;
  result.u_magnitude = 5e-3;
  result.u_phase_rad = 1e-3;
  result.budget = {
      {.kind = ContributionKind::fit_noise,
       .degrees_of_freedom = 4.0,
       .u_magnitude_rel = 3e-3,
       .u_phase_rad = 0.0},
      {.kind = ContributionKind::reference, .u_magnitude_rel = 4e-3, .u_phase_rad = 1e-3}};
  const ExpandedUncertainty magnitude = magnitude_uncertainty(result);
  EXPECT_NEAR(magnitude.nu_eff, 4.0 * std::pow(5.0 / 3.0, 4), 1e-9); // Welch and Satterthwaite
  EXPECT_NEAR(magnitude.k, 2.084, 1e-3);                             // t for 30.9
  EXPECT_DOUBLE_EQ(magnitude.expanded, magnitude.k * 5e-3);
  const ExpandedUncertainty phase = phase_uncertainty(result);
  EXPECT_TRUE(std::isinf(phase.nu_eff));
  EXPECT_NEAR(phase.k, 2.0, 1e-9);
}

TEST(ExpandedUncertainty, OfAMeanKeepsItsUAndGivesUOfK1) {
  analysis::RepetitionMean mean;
  mean.u_magnitude = 3e-3; // U / 2
  mean.magnitude_rel = {.u = 2e-3, .degrees_of_freedom = 7.0, .k = 3.0};
  const ExpandedUncertainty magnitude = magnitude_uncertainty(mean);
  EXPECT_DOUBLE_EQ(magnitude.expanded, 6e-3);
  EXPECT_DOUBLE_EQ(magnitude.u, 2e-3);
  EXPECT_DOUBLE_EQ(magnitude.k, 3.0);
  EXPECT_DOUBLE_EQ(magnitude.nu_eff, 7.0);
}

TEST(ExpandedUncertainty, AdvisesToRepeatWhereFewRepetitionsMakeKLarge) {
  EXPECT_THAT(advice_on_repetitions(13.97), testing::HasSubstr("repeat more often"));
  EXPECT_THAT(advice_on_repetitions(3.31), testing::HasSubstr("repeat more often")); // four
  EXPECT_EQ(advice_on_repetitions(2.8), "");
  EXPECT_EQ(advice_on_repetitions(2.0), "");
}

} // namespace
} // namespace dyncal::inline views
