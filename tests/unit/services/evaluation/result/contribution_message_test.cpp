#include "services/evaluation/result/result_messages.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;
using analysis::Distribution;
using analysis::Repeats;

void expect_equal(const Contribution& read, const Contribution& sent) {
  EXPECT_EQ(read.kind, sent.kind);
  EXPECT_EQ(read.subject, sent.subject);
  EXPECT_EQ(read.distribution, sent.distribution);
  EXPECT_EQ(read.repeats, sent.repeats);
  EXPECT_EQ(read.degrees_of_freedom, sent.degrees_of_freedom);
  EXPECT_EQ(read.u_magnitude_rel, sent.u_magnitude_rel);
  EXPECT_EQ(read.u_phase_rad, sent.u_phase_rad);
  EXPECT_EQ(read.u_lasting_magnitude_rel, sent.u_lasting_magnitude_rel);
}

TEST(ContributionMessage, EveryKindComesBackAsItWasSent) {
  std::set<wire::ContributionKind> sent_kinds;
  for (int i = 0; i <= static_cast<int>(ContributionKind::other); ++i) {
    const Contribution sent{.kind = static_cast<ContributionKind>(i),
                            .subject = "the sensor",
                            .distribution = Distribution::rectangular,
                            .degrees_of_freedom = 12.5,
                            .u_magnitude_rel = 1e-4,
                            .u_phase_rad = 2e-4,
                            .u_lasting_magnitude_rel = 3e-5};
    const wire::BudgetContribution message = to_message(sent);
    EXPECT_EQ(message.name(), sent.name());
    EXPECT_TRUE(sent_kinds.insert(message.kind()).second) << message.name();
    expect_equal(from_message(message), sent);
  }
}

TEST(ContributionMessage, EveryDistributionAndEveryRepetitionComesBackAsItWasSent) {
  for (const Distribution distribution : {Distribution::normal, Distribution::rectangular,
                                          Distribution::triangular, Distribution::arcsine}) {
    for (const Repeats repeats : {Repeats::anew, Repeats::common, Repeats::common_delay}) {
      const Contribution sent{
          .kind = ContributionKind::reference, .distribution = distribution, .repeats = repeats};
      expect_equal(from_message(to_message(sent)), sent);
    }
  }
}

TEST(ContributionMessage, InfiniteDegreesOfFreedomAreInfinityOnTheBus) {
  const wire::BudgetContribution message =
      to_message(Contribution{.kind = ContributionKind::reference, .u_phase_rad = 1e-3});
  EXPECT_TRUE(std::isinf(message.degrees_of_freedom()));
  EXPECT_TRUE(std::isinf(from_message(message).degrees_of_freedom));
}

// As a later version of the contract could send them.
TEST(ContributionMessage, UnknownValuesAreReadAsARowThatNeverAverages) {
  wire::BudgetContribution message;
  message.kind(static_cast<wire::ContributionKind>(99));
  message.subject("the shaker");
  message.name("tilt of the shaker");
  message.distribution(static_cast<wire::Distribution>(99));
  message.repeats(static_cast<wire::Repeats>(99));
  message.u_magnitude_rel(1e-3);
  const Contribution row = from_message(message);
  EXPECT_EQ(row.kind, ContributionKind::other);
  EXPECT_EQ(row.name(), "tilt of the shaker");
  EXPECT_EQ(row.distribution, Distribution::normal);
  EXPECT_EQ(row.repeats, Repeats::common);
  EXPECT_EQ(row.u_magnitude_rel, 1e-3);
}

} // namespace
} // namespace dyncal::inline evaluation
