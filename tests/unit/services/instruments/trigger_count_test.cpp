#include "services/instruments/trigger_count.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline instruments {
namespace {

// A count that knows of the sensor's trigger number `shot`.
TriggerCount count_after(std::uint64_t shot) {
  TriggerCount count;
  count.trigger_came();
  EXPECT_EQ(count.judge(shot), SeriesVerdict::first);
  return count;
}

TEST(TriggerCount, TheFirstSeriesOnlyTellsTheCount) {
  TriggerCount count;
  count.trigger_came();
  EXPECT_EQ(count.judge(17), SeriesVerdict::first); // may be that of an edge before
  EXPECT_EQ(count.last(), 17U);
  count.trigger_came();
  EXPECT_EQ(count.judge(18), SeriesVerdict::belongs);
}

TEST(TriggerCount, TriggersWithoutSeriesDoNotMakeTheFirstOneBelong) {
  TriggerCount count;
  count.trigger_may_have_come();
  count.trigger_came(); // no series comes
  count.trigger_came();
  EXPECT_EQ(count.judge(3), SeriesVerdict::first);
  count.trigger_came();
  EXPECT_EQ(count.judge(4), SeriesVerdict::belongs);
}

TEST(TriggerCount, AfterTheFirstASeriesThatDoesNotFitIsOpen) {
  TriggerCount count = count_after(17);
  count.trigger_came();
  EXPECT_EQ(count.judge(19), SeriesVerdict::open);
  count.trigger_came();
  EXPECT_EQ(count.judge(20), SeriesVerdict::belongs);
}

TEST(TriggerCount, OneMoreForEveryTriggerBelongs) {
  TriggerCount count = count_after(16);
  for (const std::uint64_t shot : {17U, 18U, 19U}) {
    count.trigger_came();
    EXPECT_EQ(count.judge(shot), SeriesVerdict::belongs) << shot;
  }
}

TEST(TriggerCount, ASeriesThatCameTooLateForItsShotIsNotTakenForTheNext) {
  TriggerCount count = count_after(1);
  count.trigger_came(); // its series, number 2, does not come in time
  count.trigger_came();
  EXPECT_EQ(count.judge(2), SeriesVerdict::late);
  EXPECT_EQ(count.judge(3), SeriesVerdict::belongs);
}

TEST(TriggerCount, ALostTraceWhoseTriggerCameDoesNotMatter) {
  TriggerCount count = count_after(1);
  count.trigger_may_have_come();
  count.trigger_came();
  EXPECT_EQ(count.judge(3), SeriesVerdict::belongs);
}

TEST(TriggerCount, WhereItMayBelongToTheLostTraceItIsLeftOutOnce) {
  TriggerCount count = count_after(1);
  count.trigger_may_have_come();
  count.trigger_came();
  EXPECT_EQ(count.judge(2), SeriesVerdict::open); // late, or the other trigger never came
  count.trigger_came();
  EXPECT_EQ(count.judge(3), SeriesVerdict::belongs);
}

TEST(TriggerCount, ASpuriousTriggerOrARestartIsLeftOutOnce) {
  TriggerCount count = count_after(5);
  count.trigger_came();
  EXPECT_EQ(count.judge(7), SeriesVerdict::open);
  count.trigger_came();
  EXPECT_EQ(count.judge(1), SeriesVerdict::open); // switched off and on
  count.trigger_came();
  EXPECT_EQ(count.judge(2), SeriesVerdict::belongs);
}

TEST(TriggerCount, ASensorThatDoesNotCountIsBelievedAfterTheFirst) {
  TriggerCount count = count_after(0);
  for (int shot = 0; shot < 3; ++shot) {
    count.trigger_came();
    count.trigger_may_have_come();
    EXPECT_EQ(count.judge(0), SeriesVerdict::belongs);
  }
}

TEST(TriggerCount, ASensorThatBeginsOrCeasesToCountHasAFirstSeriesAgain) {
  TriggerCount count = count_after(0);
  count.trigger_came();
  EXPECT_EQ(count.judge(7), SeriesVerdict::first);
  count.trigger_came();
  EXPECT_EQ(count.judge(8), SeriesVerdict::belongs);
  count.trigger_came();
  EXPECT_EQ(count.judge(0), SeriesVerdict::first);
  count.trigger_came();
  EXPECT_EQ(count.judge(0), SeriesVerdict::belongs);
}

} // namespace
} // namespace dyncal::inline instruments
