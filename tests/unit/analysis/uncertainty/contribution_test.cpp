#include "analysis/uncertainty/contribution.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr int kinds = static_cast<int>(ContributionKind::other) + 1;

TEST(Contribution, IsNamedByItsKindAndItsSubject) {
  EXPECT_EQ((Contribution{.kind = ContributionKind::fit_noise, .subject = "the sensor"}.name()),
            "noise of the sensor");
  EXPECT_EQ(Contribution{.kind = ContributionKind::reference}.name(), "reference");
  EXPECT_EQ((Contribution{.kind = ContributionKind::reference, .subject = "drift"}.name()),
            "reference drift");
  EXPECT_EQ((Contribution{.kind = ContributionKind::other, .subject = "cable"}.name()), "cable");
}

TEST(Contribution, EveryNameLeadsBackToItsKindAndSubject) {
  for (int i = 0; i < kinds; ++i) {
    const auto kind = static_cast<ContributionKind>(i);
    const bool takes_subject = parse_contribution_name(to_string(kind)).kind != kind;
    const Contribution row{.kind = kind, .subject = takes_subject ? "the DAU stamps" : ""};
    const NamedKind read = parse_contribution_name(row.name());
    EXPECT_EQ(read.kind, kind) << row.name();
    EXPECT_EQ(read.subject, row.subject) << row.name();
  }
}

TEST(Contribution, ANameOfAnotherVersionIsKeptAsItIs) {
  const NamedKind read = parse_contribution_name("noise offset");
  EXPECT_EQ(read.kind, ContributionKind::other);
  EXPECT_EQ(read.subject, "noise offset");
  EXPECT_EQ(parse_contribution_name("reference drift").subject, "drift");
  EXPECT_EQ(parse_contribution_name("").kind, ContributionKind::other);
}

TEST(Contribution, WhatRepeatsFollowsFromTheKindUnlessARowSaysOtherwise) {
  EXPECT_EQ(Contribution{.kind = ContributionKind::stamp_jitter}.repeats, Repeats::anew);
  EXPECT_EQ(Contribution{.kind = ContributionKind::reference}.repeats, Repeats::common);
  EXPECT_EQ(Contribution{.kind = ContributionKind::clock_offset}.repeats, Repeats::common_delay);
  EXPECT_EQ((Contribution{.kind = ContributionKind::reference, .repeats = Repeats::anew}.repeats),
            Repeats::anew);
  EXPECT_EQ(Contribution{}.repeats, Repeats::common);
}

TEST(Contribution, DegreesOfFreedomAreInfiniteWhereNoneAreGiven) {
  EXPECT_TRUE(std::isinf(Contribution{}.degrees_of_freedom));
}

} // namespace
} // namespace dyncal::analysis
