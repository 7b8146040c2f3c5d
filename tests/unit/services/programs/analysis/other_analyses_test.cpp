#include "services/programs/analysis/other_analyses.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

const RunKey run{"b1", "r1"};
const bus::Clock::Instant begin{1h};
const OtherAnalyses::InUse in_use = [](const RunKey& key) { return key.second == "in use"; };

wire::ServiceStatus status_of(const std::string& service, wire::ArmState arm,
                              const std::string& run_name = "r1") {
  wire::ServiceStatus status;
  status.bench("b1");
  status.run(run_name);
  status.service(service);
  status.arm(arm);
  return status;
}

TEST(OtherAnalysesTest, KnowsALeaderUntilItHasBeenSilentForTheLimit) {
  OtherAnalyses others("b", in_use);
  EXPECT_FALSE(others.leader(run, begin));
  others.add(status_of("a", wire::ARM_ARMED), begin);
  EXPECT_EQ(others.leader(run, begin + OtherAnalyses::silence_limit)->service, "a");
  EXPECT_FALSE(others.leader(run, begin + OtherAnalyses::silence_limit + 1ns));
  EXPECT_EQ(others.last_leader(run)->service, "a");
  EXPECT_FALSE(others.leader({"b2", "r1"}, begin));
}

TEST(OtherAnalysesTest, DoesNotTakeItselfForAnother) {
  OtherAnalyses others("b", in_use);
  others.add(status_of("b", wire::ARM_ARMED), begin);
  EXPECT_FALSE(others.last_leader(run));
}

TEST(OtherAnalysesTest, BothOfTwoThatHaveBegunARunComeToTheSameDecision) {
  for (const bool a_armed : {false, true}) {
    for (const bool b_armed : {false, true}) {
      OtherAnalyses of_a("a", in_use);
      OtherAnalyses of_b("b", in_use);
      of_a.add(status_of("b", b_armed ? wire::ARM_ARMED : wire::ARM_WAITING), begin);
      of_b.add(status_of("a", a_armed ? wire::ARM_ARMED : wire::ARM_WAITING), begin);
      const bool a_gives_way = of_a.must_give_way(run, a_armed, begin);
      const bool b_gives_way = of_b.must_give_way(run, b_armed, begin);
      EXPECT_NE(a_gives_way, b_gives_way) << a_armed << b_armed;
      EXPECT_EQ(a_gives_way, b_armed && !a_armed) << a_armed << b_armed;
    }
  }
}

TEST(OtherAnalysesTest, ForgetsTheRunsOfWhichItHeardLeast) {
  OtherAnalyses others("b", in_use);
  for (std::size_t i = 0; i <= OtherAnalyses::max_runs; ++i) {
    others.add(status_of("a", wire::ARM_ARMED, "r" + std::to_string(i)),
               begin + std::chrono::milliseconds(i));
  }
  EXPECT_FALSE(others.last_leader({"b1", "r0"}));
  EXPECT_TRUE(others.last_leader({"b1", "r1"}));
  EXPECT_EQ(others.left_out(), 1U);
}

TEST(OtherAnalysesTest, KnowsWhoLeadsARunThatIsInUseWhateverElseComes) {
  OtherAnalyses others("b", in_use);
  others.add(status_of("a", wire::ARM_ARMED, "in use"), begin);
  for (std::size_t i = 0; i < 2 * OtherAnalyses::max_runs; ++i) {
    others.add(status_of("c", wire::ARM_ARMED, "r" + std::to_string(i)), begin + 1ms);
  }
  EXPECT_EQ(others.leader({"b1", "in use"}, begin + 2ms)->service, "a");
  EXPECT_EQ(others.left_out(), OtherAnalyses::max_runs + 1);
}

} // namespace
} // namespace dyncal::inline programs
