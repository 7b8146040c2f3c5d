#include "services/programs/analysis/followed_runs.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

class FollowedRunsTest : public testing::Test {
protected:
  static wire::Measurement measurement() { return {}; }
  void say(const RunKey& run, wire::ArmState arm, const std::string& service = "other") {
    wire::ServiceStatus status;
    status.bench(run.first);
    status.run(run.second);
    status.service(service);
    status.arm(arm);
    others_.add(status, now_);
  }
  void hear(const RunKey& run, int times = 1) {
    for (int i = 0; i < times; ++i) {
      runs_.add(run, measurement(), now_);
    }
  }

  FollowedRuns::Instant now_{1h};
  OtherAnalyses others_{"own", [](const RunKey&) { return true; }};
  FollowedRuns runs_{others_};
  const RunKey run_{"acc-1", "r1"};
};

TEST_F(FollowedRunsTest, TakesARunForDesertedThatGoesOnWithoutItsLeader) {
  say(run_, wire::ARM_ARMED);
  hear(run_, 2);
  now_ += OtherAnalyses::silence_limit;
  EXPECT_EQ(runs_.deserted(now_), nullptr) << "its leader may still speak";
  now_ += 1s;
  hear(run_);
  ASSERT_NE(runs_.deserted(now_), nullptr);
  EXPECT_EQ(runs_.deserted(now_)->first, run_);
  runs_.deserted(now_)->second.left_alone = true;
  EXPECT_EQ(runs_.deserted(now_), nullptr);
}

TEST_F(FollowedRunsTest, LeavesARunThatHasEndedOrWasHeardOfOnce) {
  const RunKey once{"acc-1", "r2"};
  say(run_, wire::ARM_FINISHED);
  hear(run_, 2);
  hear(once);
  now_ += OtherAnalyses::silence_limit + 1s;
  hear(run_);
  EXPECT_EQ(runs_.deserted(now_), nullptr);
  EXPECT_EQ(runs_.messages(once), 1);
}

TEST_F(FollowedRunsTest, KeepsAnExcitationThatCameBeforeItsRun) {
  wire::Excitation excitation;
  excitation.step(3);
  runs_.add(run_, excitation, now_);
  EXPECT_EQ(runs_.messages(run_), 0);
  hear(run_, 2);
  now_ += OtherAnalyses::silence_limit + 1ms;
  hear(run_);
  ASSERT_NE(runs_.deserted(now_), nullptr);
  EXPECT_EQ(runs_.deserted(now_)->second.excitation->step(), 3U);
}

TEST_F(FollowedRunsTest, KnowsThatAnotherServiceLeadsARunOfTheBench) {
  hear(run_, 2);
  EXPECT_FALSE(runs_.leads_other("acc-1", now_));
  say(run_, wire::ARM_ARMED);
  EXPECT_TRUE(runs_.leads_other("acc-1", now_));
  EXPECT_FALSE(runs_.leads_other("acc-2", now_));
  say(run_, wire::ARM_FINISHED);
  EXPECT_FALSE(runs_.leads_other("acc-1", now_));
}

TEST_F(FollowedRunsTest, IsBoundedAndKeepsRunsThatRepeat) {
  hear(run_, 2);
  for (std::size_t i = 0; i < FollowedRuns::max_runs + 10; ++i) {
    hear({"flood", std::to_string(i)});
  }
  EXPECT_EQ(runs_.size(), FollowedRuns::max_runs);
  EXPECT_EQ(runs_.messages(run_), 2);
  EXPECT_EQ(runs_.left_out(), 11U);
}

} // namespace
} // namespace dyncal::inline programs
