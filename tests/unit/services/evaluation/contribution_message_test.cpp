#include "services/evaluation/contribution_message.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::services {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;

TEST(ContributionMessage, ComesBackAsItWasSent) {
  const Contribution sent{.kind = ContributionKind::quantisation,
                          .subject = "the sensor",
                          .distribution = analysis::Distribution::rectangular,
                          .degrees_of_freedom = 12.5,
                          .u_magnitude_rel = 1e-4,
                          .u_phase_rad = 2e-4};
  const wire::BudgetContribution message = contribution_message(sent);
  EXPECT_EQ(message.name(), "quantisation of the sensor");
  const Contribution read = contribution_of(message);
  EXPECT_EQ(read.kind, sent.kind);
  EXPECT_EQ(read.subject, sent.subject);
  EXPECT_EQ(read.distribution, sent.distribution);
  EXPECT_EQ(read.repeats, sent.repeats);
  EXPECT_EQ(read.degrees_of_freedom, sent.degrees_of_freedom);
  EXPECT_EQ(read.u_magnitude_rel, sent.u_magnitude_rel);
  EXPECT_EQ(read.u_phase_rad, sent.u_phase_rad);
}

TEST(ContributionMessage, InfiniteDegreesOfFreedomStayInfinite) {
  const wire::BudgetContribution message =
      contribution_message({.kind = ContributionKind::reference, .u_phase_rad = 1e-3});
  EXPECT_TRUE(std::isinf(contribution_of(message).degrees_of_freedom));
}

// The message does not tell which part of stamp noise only shortens the amplitude.
TEST(ContributionMessage, TheMagnitudeOfStampNoiseIsTakenToLast) {
  const Contribution read =
      contribution_of(contribution_message({.kind = ContributionKind::stamp_tick,
                                            .subject = "the DAU stamps",
                                            .u_magnitude_rel = 3e-5}));
  EXPECT_EQ(read.repeats, analysis::Repeats::anew);
  EXPECT_EQ(read.u_lasting_magnitude_rel, 3e-5);
}

} // namespace
} // namespace dyncal::services
