#include "services/dso/trigger_count.hpp"

#include <gtest/gtest.h>

namespace dyncal::services::dso {
namespace {

TEST(TriggerCount, OneMoreForEveryTriggerBelongs) {
  TriggerCount count;
  for (const std::uint64_t shot : {17U, 18U, 19U}) {
    count.trigger_came();
    EXPECT_EQ(count.judge(shot), SeriesVerdict::belongs) << shot;
  }
}

TEST(TriggerCount, ASeriesThatCameTooLateForItsShotIsNotTakenForTheNext) {
  TriggerCount count;
  count.trigger_came();
  ASSERT_EQ(count.judge(1), SeriesVerdict::belongs);
  count.trigger_came(); // its series, number 2, does not come in time
  count.trigger_came();
  EXPECT_EQ(count.judge(2), SeriesVerdict::late);
  EXPECT_EQ(count.judge(3), SeriesVerdict::belongs);
}

TEST(TriggerCount, ALostTraceWhoseTriggerCameDoesNotMatter) {
  TriggerCount count;
  count.trigger_came();
  ASSERT_EQ(count.judge(1), SeriesVerdict::belongs);
  count.trigger_may_have_come();
  count.trigger_came();
  EXPECT_EQ(count.judge(3), SeriesVerdict::belongs);
}

TEST(TriggerCount, WhereItMayBelongToTheLostTraceItIsLeftOutOnce) {
  TriggerCount count;
  count.trigger_came();
  ASSERT_EQ(count.judge(1), SeriesVerdict::belongs);
  count.trigger_may_have_come();
  count.trigger_came();
  EXPECT_EQ(count.judge(2), SeriesVerdict::open); // late, or the other trigger never came
  count.trigger_came();
  EXPECT_EQ(count.judge(3), SeriesVerdict::belongs);
}

TEST(TriggerCount, ASpuriousTriggerOrARestartIsLeftOutOnce) {
  TriggerCount count;
  count.trigger_came();
  ASSERT_EQ(count.judge(5), SeriesVerdict::belongs);
  count.trigger_came();
  EXPECT_EQ(count.judge(7), SeriesVerdict::open);
  count.trigger_came();
  EXPECT_EQ(count.judge(1), SeriesVerdict::open); // switched off and on
  count.trigger_came();
  EXPECT_EQ(count.judge(2), SeriesVerdict::belongs);
}

TEST(TriggerCount, ASensorThatDoesNotCountIsBelieved) {
  TriggerCount count;
  for (int shot = 0; shot < 3; ++shot) {
    count.trigger_came();
    count.trigger_may_have_come();
    EXPECT_EQ(count.judge(0), SeriesVerdict::belongs);
  }
}

} // namespace
} // namespace dyncal::services::dso
