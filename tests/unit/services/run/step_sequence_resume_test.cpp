// A run whose conductor has died is resumed, or refused. No real time passes.
#include "services/run/step_sequence.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/run/disturbed_run.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using run_tests::Attempt;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class StepSequenceResumeTest : public run_tests::DisturbedRun {};

// ---- resumed

TEST_F(StepSequenceResumeTest, AResumedRunGoesOnBehindTheResultsThatAreThere) {
  published_[1] = good({1, 1});
  analysis_.publish(good({1, 1}));
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  // The second step may have been excited when the conductor died.
  EXPECT_THAT(excited_, ElementsAre(Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}));
  EXPECT_THAT(attempts_of(*outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(notices_, Contains("run 'r1' is resumed, with 1 results so far"));
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
}

// Conductor and analysis have died together: which steps are left shows when the next analysis has
// evaluated what the sources have kept.
TEST_F(StepSequenceResumeTest, AResumedRunWaitsUntilTheAnalysisKnowsWhatWasMeasured) {
  silent_ = true; // played here until it is done
  clock_.every(1s, [this] {
    if (silent_ && clock_.elapsed() < 200s) {
      analysis_.report(wire::ARM_ARMED, wire::HEALTH_WAITING,
                       fmt::format("taking the run over: {} messages", clock_.elapsed() / 1s));
    } else if (silent_) {
      published_[1] = good({1, 1});
      analysis_.publish(good({1, 1}));
      silent_ = false;
    }
  });
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_THAT(excited_, ElementsAre(Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(notices_, Contains("run 'r1' is resumed, with 1 results so far"));
}

TEST_F(StepSequenceResumeTest, NothingIsExcitedWhileAnotherAnalysisTakesTheRunOver) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 220s); // in the second step
  clock_.every(1s, [this] {
    if (clock_.elapsed() > 20s && clock_.elapsed() < 220s) {
      EXPECT_FALSE(instrument_.on);
      analysis_.report(wire::ARM_ARMED, wire::HEALTH_WAITING,
                       fmt::format("taking the run over: {} messages", clock_.elapsed() / 1s));
    }
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, ""); // it reports that it is at work
  ASSERT_EQ(outcome.pauses.size(), 2U);
  EXPECT_THAT(outcome.pauses[0].reason, HasSubstr("has gone silent"));
  EXPECT_THAT(outcome.pauses[1].reason, HasSubstr("taking the run over"));
  EXPECT_EQ(std::count_if(notices_.begin(), notices_.end(),
                          [](const std::string& notice) {
                            return notice.find("taking the run over") != std::string::npos;
                          }),
            1);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceResumeTest, ARunThatDiedInARepeatIsResumedThere) {
  for (const Attempt& attempt : {Attempt{1, 1}, Attempt{2, 2}, Attempt{3, 1}}) {
    published_[attempt.first] = attempt.first == 1 ? lossy(attempt) : good(attempt);
    analysis_.publish(published_[attempt.first]);
  }
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 2}));
  EXPECT_THAT(attempts_of(*outcome), ElementsAre(2, 2, 1));
}

TEST_F(StepSequenceResumeTest, ARunThatNobodyHoldsIsNotResumed) {
  silent_ = true;
  const auto outcome = try_to_resume();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().message,
            "no analysis service holds run 'r1' of bench 'b'; begin a new run");
  EXPECT_EQ(instrument_.connections, 0);
}

TEST_F(StepSequenceResumeTest, OfARunThatHasEndedTheResultsAreCollected) {
  finished_ = true;
  for (const std::uint32_t step : {1U, 2U, 3U}) {
    analysis_.publish(good({step, 1}));
  }
  clock_.at(1s, [this] { analysis_.report(wire::ARM_FINISHED); });
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 3U);
  follow_run();
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_THAT(notices_, Contains("run 'r1' has ended at the analysis service analysis@test:1; its "
                                 "results are collected"));
  EXPECT_EQ(instrument_.connections, 0);
}

TEST_F(StepSequenceResumeTest, OfARunThatHasEndedTheMissingStepsAreNamed) {
  finished_ = true;
  analysis_.publish(good({1, 1}));
  clock_.at(1s, [this] { analysis_.report(wire::ARM_FINISHED); });
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "run 'r1' had ended at the analysis service analysis@test:1 before 2 "
                              "of its 3 steps; begin a new run for those");
  EXPECT_EQ(outcome->results.size(), 1U);
  follow_run();
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_EQ(instrument_.connections, 0);
}

TEST_F(StepSequenceResumeTest, AnEndedRunOfAnotherBenchFileIsNotTakenForThisOne) {
  bench_.sha256 = "new";
  finished_ = true;
  wire::CalibrationResult result = good({1, 1});
  result.recipe_sha256("old");
  analysis_.publish(result);
  clock_.at(1s, [this] { analysis_.report(wire::ARM_FINISHED); });
  const auto outcome = try_to_resume();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::bad_file);
  EXPECT_LT(clock_.elapsed(), 5s);
}

TEST_F(StepSequenceResumeTest, ARunOfAnotherBenchFileIsNotResumed) {
  bench_.sha256 = "new";
  wire::CalibrationResult result = good({1, 1});
  result.recipe_sha256("old");
  analysis_.publish(result);
  const auto outcome = try_to_resume();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::bad_file);
  EXPECT_EQ(instrument_.connections, 0);
}

} // namespace
} // namespace dyncal::inline run
