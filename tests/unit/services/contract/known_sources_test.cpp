#include "services/contract/known_sources.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

wire::SourceDescription description(std::uint64_t session) {
  wire::SourceDescription description;
  description.bench("b");
  description.source("dau");
  description.session(session);
  description.device("sensor " + std::to_string(session));
  return description;
}

wire::SourceStatus status(std::uint64_t session) {
  wire::SourceStatus status;
  status.bench("b");
  status.source("dau");
  status.session(session);
  return status;
}

TEST(KnownSource, IsDescribedByItselfAgainWhenATwinHasGone) {
  KnownSource source;
  source.take(description(1));
  EXPECT_FALSE(source.take(status(1)));
  source.take(description(2));
  for (int i = 0; i < 5; ++i) { // both live: the newer description stays
    EXPECT_FALSE(source.take(status(2)));
    EXPECT_FALSE(source.take(status(1)));
  }
  EXPECT_EQ(source.description->session(), 2U);
  EXPECT_FALSE(source.take(status(1)));
  const auto left = source.take(status(1));
  ASSERT_TRUE(left);
  EXPECT_EQ(left->session(), 2U);
  EXPECT_EQ(source.description->session(), 1U);
  EXPECT_EQ(source.description->device(), "sensor 1");
}

// Of two that write at once, a late reader sees the second alone: the first seems to have gone.
TEST(KnownSource, IsDescribedByTheOneThatGoesOnThoughItSeemedToHaveGone) {
  KnownSource source;
  source.take(description(2)); // the twin's
  source.take(description(1));
  for (int i = 1; i <= KnownSource::statuses_of_a_living_session; ++i) {
    EXPECT_EQ(source.take(status(2)).has_value(), i == KnownSource::statuses_of_a_living_session);
  }
  ASSERT_EQ(source.description->session(), 2U);
  for (int i = 0; i < KnownSource::statuses_of_a_living_session - 1; ++i) { // the twin has ended
    EXPECT_FALSE(source.take(status(1)));
  }
  EXPECT_TRUE(source.take(status(1)));
  EXPECT_EQ(source.description->device(), "sensor 1");
}

TEST(KnownSource, IsDescribedByItselfAfterAProgramThatOnlyDescribedIt) {
  KnownSource source;
  source.take(description(1));
  source.take(description(2));
  source.take(description(3));
  EXPECT_FALSE(source.take(status(1)));
  EXPECT_FALSE(source.take(status(1)));
  EXPECT_TRUE(source.take(status(1)));
  EXPECT_EQ(source.description->session(), 1U);
}

TEST(KnownSource, ThatWasRestartedIsDescribedByItsNewSession) {
  KnownSource source;
  source.take(description(1));
  source.take(description(2));
  EXPECT_FALSE(source.take(status(1))); // its last, late
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(source.take(status(2)));
  }
  EXPECT_EQ(source.description->session(), 2U);
  ASSERT_TRUE(source.before());
  EXPECT_EQ(source.before()->session(), 1U);
}

TEST(KnownSource, KeepsTheDescriptionsOfFewSessions) {
  KnownSource source;
  for (std::uint64_t session = 1; session <= 100; ++session) {
    source.take(description(session));
    source.take(description(session));
  }
  EXPECT_EQ(source.earlier.size(), KnownSource::max_earlier);
  EXPECT_EQ(source.before()->session(), 99U);
}

} // namespace
} // namespace dyncal::inline contract
