#include "services/run/step_repeats.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline run {
namespace {

StepResult good(std::uint32_t step, std::uint32_t attempt = 1,
                const std::string& channel = "dau/x") {
  StepResult result;
  result.channel = channel;
  result.step = step;
  result.attempt = attempt;
  result.valid = true;
  return result;
}

StepResult with_loss(StepResult result) {
  result.lost = 50;
  return result;
}

StepResult with(ResultFlag flag, StepResult result) {
  result.flags.push_back(make_flag(flag));
  return result;
}

StepResult without_value(StepResult result, const std::string& problem) {
  result.valid = false;
  result.problem = problem;
  return result;
}

class StepRepeatsTest : public testing::Test {
protected:
  StepRepeats repeats_{{1, 2, 3}, 3};

  void SetUp() override {
    for (const std::uint32_t step : {1U, 2U, 3U}) {
      EXPECT_EQ(repeats_.begin(step), 1U);
    }
  }
  [[nodiscard]] std::uint32_t next(const std::vector<StepResult>& results) const {
    const auto repeat = repeats_.next(results);
    return repeat ? repeat->step : 0;
  }
};

TEST_F(StepRepeatsTest, NothingIsRepeatedOfAGoodRun) {
  EXPECT_EQ(next({good(1), good(2), good(3)}), 0U);
}

TEST_F(StepRepeatsTest, AStepWithALossIsRepeatedUpToTheLimitAndThenStaysAsItIs) {
  std::vector<StepResult> results{good(1), with_loss(good(2)), good(3)};
  EXPECT_EQ(repeats_.next(results)->reason, "50 samples lost");
  for (const std::uint32_t attempt : {2U, 3U}) {
    EXPECT_EQ(next(results), 2U);
    EXPECT_EQ(repeats_.begin(2), attempt);
    results[1] = with_loss(good(2, attempt));
  }
  EXPECT_EQ(next(results), 0U);
}

TEST_F(StepRepeatsTest, OnlyWhatAnotherAttemptMayCureIsAReason) {
  for (const ResultFlag flag : {ResultFlag::samples_lost, ResultFlag::shorter_than_planned,
                                ResultFlag::excitation_broken_off, ResultFlag::shots_missing,
                                ResultFlag::shots_left_out, ResultFlag::records_lost,
                                ResultFlag::stamps_not_trusted, ResultFlag::values_not_measured}) {
    EXPECT_EQ(next({good(1), with(flag, good(2)), good(3)}), 2U) << to_string(flag);
  }
  for (const ResultFlag flag :
       {ResultFlag::level_off_plan, ResultFlag::over_range, ResultFlag::values_stuck,
        ResultFlag::distorted, ResultFlag::clock_uncertainty_unknown, ResultFlag::start_undecided,
        ResultFlag::adc_not_calibrated, ResultFlag::mains_not_separated,
        ResultFlag::from_message}) {
    EXPECT_EQ(next({good(1), with(flag, good(2)), good(3)}), 0U) << to_string(flag);
  }
}

TEST_F(StepRepeatsTest, AResultWithoutAValueIsAReasonUnlessItsRangeIs) {
  EXPECT_EQ(next({good(1), without_value(good(2), "no steady sine"), good(3)}), 2U);
  EXPECT_EQ(next({good(1), good(2),
                  with(ResultFlag::over_range, without_value(good(3), "over its range"))}),
            0U);
}

TEST_F(StepRepeatsTest, AChannelThatNeverHasAValueIsNone) {
  std::vector<StepResult> results;
  for (const std::uint32_t step : {1U, 2U, 3U}) {
    results.push_back(good(step));
    results.push_back(without_value(good(step, 1, "dau/broken"), "no signal"));
  }
  EXPECT_EQ(next(results), 0U);
  results[3] = good(2, 1, "dau/broken"); // it has one after all
  EXPECT_EQ(next(results), 1U);
}

TEST_F(StepRepeatsTest, TheOnlyStepOfARunIsRepeatedWithoutAnyValue) {
  StepRepeats one({7}, 3);
  one.begin(7);
  EXPECT_EQ(one.next({without_value(good(7), "no steady sine")})->step, 7U);
}

TEST_F(StepRepeatsTest, AStepThatWasBrokenOffIsRepeatedWhateverItsResult) {
  repeats_.broken_off(3);
  const std::vector<StepResult> results{good(1), good(2), good(3)};
  EXPECT_EQ(next(results), 3U);
  EXPECT_EQ(repeats_.next(results)->reason, "its excitation was broken off");
  repeats_.begin(3);
  EXPECT_EQ(next(results), 0U);
}

TEST_F(StepRepeatsTest, AllHaveTheirSecondAttemptBeforeOneHasItsThird) {
  const std::vector<StepResult> results{with_loss(good(1)), good(2), with_loss(good(3))};
  EXPECT_EQ(next(results), 1U);
  repeats_.begin(1);
  EXPECT_EQ(next(results), 3U);
  repeats_.begin(3);
  EXPECT_EQ(next(results), 1U);
}

TEST_F(StepRepeatsTest, OnRequestAStepIsRepeatedBeyondTheLimit) {
  StepRepeats once({1, 2}, 1);
  once.begin(1);
  once.begin(2);
  const std::vector<StepResult> results{good(1), with_loss(good(2))};
  EXPECT_FALSE(once.next(results));
  once.ask_for(9); // not of the plan
  EXPECT_FALSE(once.next(results));
  once.ask_for(1);
  EXPECT_EQ(once.next(results)->step, 1U);
  EXPECT_EQ(once.next(results)->reason, "asked for");
  once.begin(1);
  EXPECT_FALSE(once.next(results));
}

TEST_F(StepRepeatsTest, AStepIsEvaluatedWithTheResultsOfItsLastAttemptOfEveryChannel) {
  EXPECT_FALSE(repeats_.are_evaluated({}));
  std::vector<StepResult> results{good(1), good(2), good(3), good(1, 1, "dau/y"),
                                  good(2, 1, "dau/y")};
  EXPECT_FALSE(repeats_.are_evaluated(results));
  results.push_back(good(3, 1, "dau/y"));
  EXPECT_TRUE(repeats_.are_evaluated(results));
  repeats_.begin(2);
  EXPECT_FALSE(repeats_.are_evaluated(results));
  results[1].attempt = 2;
  EXPECT_FALSE(repeats_.are_evaluated(results));
  results[4].attempt = 2;
  EXPECT_TRUE(repeats_.are_evaluated(results));
}

} // namespace
} // namespace dyncal::inline run
