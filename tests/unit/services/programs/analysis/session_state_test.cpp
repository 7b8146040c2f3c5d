#include "services/programs/analysis/session_state.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using Instant = bus::Clock::Instant;

TEST(SessionState, IsReportedAsTheContractHasIt) {
  struct Row {
    SessionState state;
    wire::ArmState arm;
    wire::HealthState health;
  };
  const Row rows[] = {
      {Arming{}, wire::ARM_WAITING, wire::HEALTH_OK},
      {TakingOver{}, wire::ARM_ARMED, wire::HEALTH_WAITING},
      {Attending{}, wire::ARM_ARMED, wire::HEALTH_OK},
      {Held{}, wire::ARM_ARMED, wire::HEALTH_WAITING},
      {Failed{}, wire::ARM_ARMED, wire::HEALTH_FAILED},
      {Failed{false}, wire::ARM_WAITING, wire::HEALTH_FAILED},
      {Ended{}, wire::ARM_FINISHED, wire::HEALTH_OK},
      {Ended{wire::ARM_REFUSED, wire::HEALTH_FAILED}, wire::ARM_REFUSED, wire::HEALTH_FAILED},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(arm_of(row.state), row.arm) << row.state.index();
    EXPECT_EQ(health_of(row.state), row.health) << row.state.index();
  }
}

TEST(SessionState, KnowsSinceWhenASourceIsAway) {
  const Instant since = Instant{} + 3s;
  const Instant now = Instant{} + 9s;
  EXPECT_EQ(waits_since(Held{since}, now), since);
  EXPECT_EQ(waits_since(TakingOver{since}, now), since);
  EXPECT_EQ(waits_since(Attending{}, now), now);
}

TEST(Arming, WaitsLongerForASourceThatIsThere) {
  Arming arming{Instant{} + 100s};
  const MissingSource away{"", false, false};
  const MissingSource there{"", true, false};
  EXPECT_FALSE(arming.is_over(away, arming.since + Arming::limit));
  EXPECT_TRUE(arming.is_over(away, arming.since + Arming::limit + 1ms));
  EXPECT_FALSE(arming.is_over(there, arming.since + Arming::present_limit));
  EXPECT_TRUE(arming.is_over(there, arming.since + Arming::present_limit + 1ms));
}

TEST(Arming, GivesASourceThatHasStartedTimeToAnswer) {
  Arming arming{Instant{} + 100s};
  const MissingSource starting{"", true, true};
  EXPECT_FALSE(arming.is_over(starting, arming.since + 14s));
  const MissingSource there{"", true, false};
  EXPECT_FALSE(arming.is_over(there, arming.since + 14s + Arming::limit));
  EXPECT_TRUE(arming.is_over(there, arming.since + 14s + Arming::limit + 1ms));
}

} // namespace
} // namespace dyncal::inline programs
