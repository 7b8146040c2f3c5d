// Steps that are repeated, on request or since their results are bad. No real time passes.
#include "services/run/step_sequence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/run/disturbed_run.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using run_tests::Attempt;
using testing::Contains;
using testing::ElementsAre;

class StepSequenceRepeatsTest : public run_tests::DisturbedRun {};

TEST_F(StepSequenceRepeatsTest, AStepIsRepeatedOnceOnRequestHoweverOftenTheCommandComes) {
  bench_.excitation.attempts = 1;
  for (const auto at : {1s, 2s, 3s, 8s}) {
    clock_.at(at, [this] { command(wire::COMMAND_REPEAT, 1); });
  }
  clock_.at(4s, [this] { command(wire::COMMAND_REPEAT, 99); });
  const RunOutcome outcome = conduct();
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{1, 2}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(2, 1, 1));
  EXPECT_THAT(notices_, Contains("step 1 is excited again, attempt 2: asked for"));
}

// ---- repeats

TEST_F(StepSequenceRepeatsTest, AStepWithALossIsRepeatedUntilItIsWithout) {
  evaluate_ = [](Attempt attempt) {
    return attempt.first == 2 && attempt.second < 3 ? lossy(attempt) : good(attempt);
  };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2},
                                    Attempt{2, 3}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 3, 1));
  EXPECT_EQ(outcome.results[1].lost, 0U);
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(repeated_steps_, ElementsAre(2, 2));
  EXPECT_THAT(notices_, ElementsAre("step 2 is excited again, attempt 2: 50 samples lost",
                                    "step 2 is excited again, attempt 3: 50 samples lost"));
}

TEST_F(StepSequenceRepeatsTest, AStepThatStaysBadHasAsManyAttemptsAsTheBenchFileAllows) {
  bench_.excitation.attempts = 4;
  evaluate_ = [](Attempt attempt) { return attempt.first == 1 ? lossy(attempt) : good(attempt); };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(attempts_of(outcome), ElementsAre(4, 1, 1));
  EXPECT_EQ(outcome.results[0].lost, 50U); // as it is
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
}

TEST_F(StepSequenceRepeatsTest, WithOneAttemptNothingIsRepeated) {
  bench_.excitation.attempts = 1;
  evaluate_ = lossy;
  EXPECT_THAT(attempts_of(conduct()), ElementsAre(1, 1, 1));
}

TEST_F(StepSequenceRepeatsTest, AnAttemptIsAnnouncedOnlyAfterTheResultsOfTheOneBefore) {
  evaluate_ = [this](Attempt attempt) {
    if (attempt == Attempt{3, 1}) { // comes late
      clock_.at(clock_.elapsed() + 15s, [this] {
        EXPECT_EQ(excited_.size(), 3U);
        analysis_.publish(lossy({3, 1}));
      });
      return wire::CalibrationResult{};
    }
    return good(attempt);
  };
  EXPECT_THAT(attempts_of(conduct()), ElementsAre(1, 1, 2));
}

// A changed packet took the place of the message: counts of results do not tell that it is missing.
TEST_F(StepSequenceRepeatsTest, TheResultOfARepeatThatWasMissedIsCollectedOnceMore) {
  evaluate_ = [](Attempt attempt) {
    return attempt == Attempt{2, 1} ? lossy(attempt) : good(attempt);
  };
  bool missed = false;
  network_.lose([&](const bus::MessageInTransit& message) {
    return message.topic == bus::topics::calibration_result.name &&
           message.as<wire::CalibrationResult>().attempt() == 2 && !std::exchange(missed, true);
  });
  const RunOutcome outcome = conduct();
  EXPECT_TRUE(missed);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_EQ(outcome.results[1].lost, 0U);
  EXPECT_EQ(outcome.problem, "");
}

TEST_F(StepSequenceRepeatsTest, ARunWhoseResultsDoNotComeEndsWithoutRepeats) {
  evaluate_ = [](Attempt attempt) {
    return attempt.first == 3 ? wire::CalibrationResult{} : lossy(attempt);
  };
  const RunOutcome outcome = conduct();
  EXPECT_EQ(excited_.size(), 3U);
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_GT(clock_.elapsed(), StepSequence::results_limit);
}

TEST_F(StepSequenceRepeatsTest, ARepeatIsPausedAndBrokenOffLikeAnyStep) {
  bench_.excitation.duration_s = 10.0;
  evaluate_ = [](Attempt attempt) {
    return attempt == Attempt{1, 1} ? lossy(attempt) : good(attempt);
  };
  silent_between(40s, 50s); // the repeat begins at about 35 s
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{1, 2},
                                    Attempt{1, 3}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{1, 2}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(3, 1, 1));
}

} // namespace
} // namespace dyncal::inline run
