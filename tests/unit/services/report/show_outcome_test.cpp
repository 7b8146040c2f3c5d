#include "services/report/show_outcome.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::services {
namespace {

using testing::HasSubstr;

RunOutcome outcome_of_steps(std::size_t planned, std::size_t measured) {
  RunOutcome outcome;
  outcome.planned_steps = planned;
  for (std::uint32_t step = 1; step <= planned; ++step) {
    for (const char* channel : {"dau/x", "dau/y"}) {
      StepResult result;
      result.channel = channel;
      result.step = step;
      result.valid = step <= measured;
      outcome.results.push_back(result);
    }
  }
  return outcome;
}

TEST(ShowOutcome, ARunIsCompleteWhenEveryStepHasAResult) {
  EXPECT_TRUE(check_complete(outcome_of_steps(3, 3)));
}

TEST(ShowOutcome, StepsWithoutAResultAreCounted) {
  const auto checked = check_complete(outcome_of_steps(3, 1));
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::no_result);
  EXPECT_THAT(checked.error().message, HasSubstr("2 of 3 steps have no result"));
}

TEST(ShowOutcome, AChannelWithoutAnyResultIsNamed) {
  RunOutcome outcome = outcome_of_steps(3, 3);
  for (StepResult& result : outcome.results) {
    result.valid = result.channel == "dau/x";
  }
  const auto checked = check_complete(outcome);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::no_result);
  EXPECT_THAT(checked.error().message,
              HasSubstr("1 of the channels under calibration has no result at any step: dau/y"));
  outcome.results[1].valid = true; // at one step is enough: the table shows where
  EXPECT_TRUE(check_complete(outcome));
}

TEST(ShowOutcome, AnInterruptedRunKeepsWhatItMeasured) {
  RunOutcome outcome = outcome_of_steps(3, 1);
  outcome.interrupted = true;
  const auto checked = check_complete(outcome);
  EXPECT_EQ(checked.error().code, ErrorCode::interrupted);
  EXPECT_THAT(checked.error().message, HasSubstr("1 of 3 steps were measured and kept"));
}

TEST(ShowOutcome, WhatEndedARunEarlyComesFirst) {
  RunOutcome outcome = outcome_of_steps(3, 1);
  outcome.problem = "the shaker stopped";
  EXPECT_THAT(check_complete(outcome).error().message, HasSubstr("the shaker stopped; 1 of 3"));
}

} // namespace
} // namespace dyncal::services
