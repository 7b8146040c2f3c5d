// Analysis, source or generator are away while a run is excited, at every limit: the output is off
// meanwhile, the run goes on when it can, and what was spoilt is repeated. No real time passes.
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
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class StepSequenceAbsenceTest : public run_tests::DisturbedRun {};

// ---- the analysis is away

TEST_F(StepSequenceAbsenceTest, AStepIsBrokenOffWhileTheAnalysisIsSilentAndRepeatedAtTheEnd) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 60s); // in the second step
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}));
  EXPECT_THAT(repeated_steps_, ElementsAre(2));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_LE(longest_unattended_, attention_limit + 1s + 200ms);
  EXPECT_FALSE(began_unattended_);
  ASSERT_EQ(outcome.pauses.size(), 1U);
  const RunPause& pause = outcome.pauses[0];
  EXPECT_EQ(pause.reason, "the analysis service analysis@test:1 has gone silent; waiting for it or "
                          "another up to 120 s (the output is off)");
  EXPECT_NEAR(static_cast<double>(pause.ended_utc_ns - pause.began_utc_ns) * 1e-9, 42.5, 1.5);
  EXPECT_THAT(messages_, Contains("the analysis service analysis@test:1 has gone silent; waiting "
                                  "for it or another up to 120 s (the output is off)"));
  EXPECT_THAT(notices_, Contains(HasSubstr("waiting for it or another up to 120 s")));
  EXPECT_THAT(notices_, Contains("step 2 is excited again, attempt 2: its excitation was broken "
                                 "off"));
}

// Else a step of the same frequency could be taken for it.
TEST_F(StepSequenceAbsenceTest, TheNextStepWaitsForTheResultOfTheOneThatWasBrokenOff) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 20s);
  evaluate_ = [this](Attempt attempt) {
    if (attempt != Attempt{2, 1}) {
      return good(attempt);
    }
    clock_.at(25s, [this] {
      EXPECT_EQ(excited_.size(), 2U);
      analysis_.publish(lossy({2, 1}));
    });
    return wire::CalibrationResult{};
  };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceAbsenceTest, TheResultOfAStepThatWasBrokenOffIsNotWaitedForForever) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 20s);
  evaluate_ = [](Attempt attempt) {
    return attempt == Attempt{2, 1} ? wire::CalibrationResult{} : good(attempt);
  };
  clock_.at(34s, [this] { EXPECT_EQ(excited_.size(), 3U); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(excited_.size(), 3U); // no repeats: not all results have come
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
}

TEST_F(StepSequenceAbsenceTest, AnAnalysisThatIsSilentForJustLessThanTheLimitIsWaitedFor) {
  bench_.excitation.duration_s = 10.0;
  silent_between(5s, 4500ms + StepSequence::away_limit - 600ms);
  EXPECT_EQ(conduct().problem, "");
}

TEST_F(StepSequenceAbsenceTest, AnAnalysisThatDoesNotComeBackEndsTheRun) {
  bench_.excitation.duration_s = 10.0;
  silent_between(5s, 1000s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "the analysis service analysis@test:1 has gone silent");
  EXPECT_GT(clock_.elapsed(), 4500ms + StepSequence::away_limit);
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_NE(outcome.pauses.at(0).ended_utc_ns, 0);
}

TEST_F(StepSequenceAbsenceTest, AnotherAnalysisTakesTheRunOver) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 1000s);
  clock_.at(30s, [this] { standby_.report(wire::ARM_WAITING); });
  clock_.at(31s, [this] {
    EXPECT_FALSE(instrument_.on); // it is not armed yet
    standby_.publish(good({1, 1}));
    standby_serves_ = true;
  });
  clock_.at(70s, [this] {
    EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
    standby_serves_ = false;
    standby_.report(wire::ARM_FINISHED);
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceAbsenceTest, AStandbyThatReportsBesideTheAnalysisChangesNothing) {
  clock_.every(300ms, [this] { standby_.report(wire::ARM_WAITING, "standing by"); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(outcome.pauses, IsEmpty());
}

// An analysis that was restarted publishes everything again.
TEST_F(StepSequenceAbsenceTest, AResultOfAnEarlierAttemptTakesNoLaterOnesPlace) {
  evaluate_ = [this](Attempt attempt) {
    if (attempt == Attempt{1, 2}) {
      // taken after the other
      clock_.at(clock_.elapsed() + 250ms, [this] { analysis_.publish(lossy({1, 1})); });
    }
    return attempt == Attempt{1, 1} ? lossy(attempt) : good(attempt);
  };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(attempts_of(outcome), ElementsAre(2, 1, 1));
  EXPECT_EQ(outcome.results[0].lost, 0U);
}

TEST_F(StepSequenceAbsenceTest, NoStepIsBegunUnlessTheAnalysisWasHeardLately) {
  for (int i = 0; i < 12; ++i) { // silent again and again, in steps and between them
    silent_between(3s + i * 9s, 3s + i * 9s + 5100ms);
  }
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_FALSE(began_unattended_);
  EXPECT_LE(longest_unattended_, attention_limit + 1s + 200ms);
  EXPECT_GE(outcome.pauses.size(), 2U);
}

TEST_F(StepSequenceAbsenceTest, TheRunEndsWhenTheAnalysisHasEndedIt) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(5s, [this] {
    finished_ = true;
    analysis_.report(wire::ARM_FINISHED);
  });
  EXPECT_THAT(conduct().problem, HasSubstr("has ended the run before its last step"));
  EXPECT_LT(clock_.elapsed(), 8s);
}

// ---- a source is away

TEST_F(StepSequenceAbsenceTest, ASourceThatTheAnalysisWaitsForPausesTheRun) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] {
    health_ = wire::HEALTH_WAITING;
    message_ = "source 'dau' of bench 'b' has sent nothing for 5 s";
  });
  clock_.at(16s, [this] { EXPECT_FALSE(instrument_.on); });
  clock_.at(100s, [this] {
    health_ = wire::HEALTH_OK;
    message_.clear();
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(outcome.pauses.at(0).reason,
              StartsWith("source 'dau' of bench 'b' has sent nothing for 5 s; waiting"));
  EXPECT_THAT(notices_, Contains("source 'dau' of bench 'b' has sent nothing for 5 s; waiting for "
                                 "it up to 120 s (the output is off)"));
}

TEST_F(StepSequenceAbsenceTest, ASourceThatDoesNotComeBackEndsTheRun) {
  clock_.at(4s, [this] {
    health_ = wire::HEALTH_WAITING;
    message_ = "source 'dau' is away";
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "source 'dau' is away");
  EXPECT_GT(clock_.elapsed(), 4s + StepSequence::away_limit);
  EXPECT_LT(clock_.elapsed(), 4s + StepSequence::away_limit + 5s);
}

// ---- the generator is away

TEST_F(StepSequenceAbsenceTest, AGeneratorThatDoesNotAnswerIsSwitchedOffAsSoonAsItDoes) {
  bench_.excitation.duration_s = 10.0;
  away_between(14s, 44s);
  clock_.at(40s, [this] { EXPECT_TRUE(instrument_.on); }); // nobody reaches it
  clock_.at(46s, [this] { EXPECT_FALSE(instrument_.on && excited_.back() == Attempt(2, 1)); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_FALSE(outcome.output_may_be_on);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(outcome.pauses.at(0).reason, StartsWith("the instrument does not answer; waiting"));
  EXPECT_THAT(notices_, Contains(HasSubstr("THE OUTPUT OF THE GENERATOR MAY BE ON")));
}

TEST_F(StepSequenceAbsenceTest, AGeneratorThatDoesNotComeBackEndsTheRunAndIsNamed) {
  away_between(4s, 2000s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "the instrument does not answer");
  EXPECT_TRUE(outcome.output_may_be_on);
  EXPECT_TRUE(outcome.output_is_guarded);
  EXPECT_GT(clock_.elapsed(), 4s + StepSequence::away_limit);
  EXPECT_LT(clock_.elapsed(), 4s + StepSequence::away_limit + 15s);
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
}

TEST_F(StepSequenceAbsenceTest, APersonWhoCannotConfirmIsNotWaitedFor) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  away_between(4s, 2000s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "the instrument does not answer");
  EXPECT_LT(clock_.elapsed(), 20s);
}

TEST_F(StepSequenceAbsenceTest, NoStepIsBegunBeforeAPersonHasConfirmedThatTheOutputIsOff) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] {
    instrument_.confirmed = false;
    command(wire::COMMAND_PAUSE);
  });
  clock_.at(30s, [this] { command(wire::COMMAND_CONTINUE); });
  clock_.at(300s, [this] {
    EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}));
    EXPECT_THAT(messages_,
                Contains("the operator has to confirm that the output is off (THE OUTPUT OF THE "
                         "GENERATOR MAY BE ON, switch it off by hand if you can)"));
    instrument_.confirmed = true;
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_FALSE(outcome.output_may_be_on);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceAbsenceTest, ARunThatEndsBeforeAPersonHasConfirmedSaysThatTheOutputMayBeOn) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  clock_.at(4500ms, [this] {
    instrument_.confirmed = false;
    stop_.request_stop();
  });
  const RunOutcome outcome = conduct();
  EXPECT_TRUE(outcome.interrupted);
  EXPECT_TRUE(outcome.output_may_be_on);
  EXPECT_FALSE(outcome.output_is_guarded);
}

TEST_F(StepSequenceAbsenceTest,
       ALossOfGeneratorAndAnalysisAtOnceIsWaitedOut) { // the operator's link
  bench_.excitation.duration_s = 10.0;
  away_between(14s, 34s);
  silent_between(14s, 37s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  ASSERT_EQ(outcome.pauses.size(), 2U);
  EXPECT_THAT(outcome.pauses[0].reason, HasSubstr("does not answer"));
  EXPECT_THAT(outcome.pauses[1].reason, HasSubstr("has gone silent"));
  EXPECT_EQ(outcome.pauses[0].ended_utc_ns, outcome.pauses[1].began_utc_ns);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

} // namespace
} // namespace dyncal::inline run
