// A run in its order, with refused settings, pauses and ends, at every limit: the output is off
// whenever nobody attends it. No real time passes.
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

class StepSequenceTest : public run_tests::DisturbedRun {};

TEST_F(StepSequenceTest, AnUndisturbedRunHasNeitherPausesNorRepeats) {
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(outcome.pauses, IsEmpty());
  EXPECT_THAT(notices_, IsEmpty());
  EXPECT_THAT(messages_, IsEmpty());
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 1, 1));
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}));
  EXPECT_LT(clock_.elapsed(), 12s); // does not wait for anything
}

// ---- a fault of a device in a step

TEST_F(StepSequenceTest, AStepWithASettingThatIsRefusedOnceIsRepeatedAtTheEnd) {
  instrument_.failing_call = "set_frequency";
  instrument_.failing_from = 2;
  instrument_.failing_times = 1;
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(outcome.pauses, IsEmpty());
  EXPECT_THAT(notices_, Contains("step 2, 80 Hz: set_frequency was refused; the step is broken "
                                 "off, the run goes on"));
}

TEST_F(StepSequenceTest, AStepThatIsRefusedInEveryAttemptIsNamedAndTheOthersAreMeasured) {
  instrument_.refused_hz = "80";
  evaluate_ = [](Attempt attempt) {
    wire::CalibrationResult result = good(attempt);
    result.valid(attempt.first != 2);
    return result;
  };
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "step 2, 80 Hz: 80 Hz was refused (attempts: 3)");
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_FALSE(instrument_.on);
  EXPECT_FALSE(outcome.output_may_be_on);
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}, Attempt{2, 2}, Attempt{2, 3}));
  ASSERT_EQ(outcome.results.size(), 3U);
  EXPECT_TRUE(outcome.results[0].valid);
  EXPECT_TRUE(outcome.results[2].valid);
}

TEST_F(StepSequenceTest, ALevelThatIsNotReachedBreaksOffItsStepAlone) {
  bench_.generator.level_tolerance_rel = 0.01; // and no source shows the level
  bench_.excitation.attempts = 2;
  const RunOutcome outcome = conduct();
  EXPECT_THAT(outcome.problem, StartsWith("step 1, 40 Hz: of acs/reference no whole window "));
  EXPECT_THAT(outcome.problem, testing::EndsWith("(attempts: 2); steps that failed as well: 2"));
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{1, 2},
                                    Attempt{2, 2}, Attempt{3, 2}));
  EXPECT_FALSE(instrument_.on);
}

TEST_F(StepSequenceTest, NoStepIsBegunBeforeTheOutputIsKnownToBeOff) {
  instrument_.failing_call = "set_output(false)";
  instrument_.failing_times = 20;
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(2, 1, 1));
  ASSERT_EQ(outcome.pauses.size(), 1U);
  EXPECT_THAT(outcome.pauses[0].reason, HasSubstr("THE OUTPUT OF THE GENERATOR MAY BE ON"));
  EXPECT_GT(outcome.pauses[0].ended_utc_ns - outcome.pauses[0].began_utc_ns, 15'000'000'000);
}

// ---- commands

TEST_F(StepSequenceTest, APauseSwitchesTheOutputOffForAsLongAsItLasts) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] { command(wire::COMMAND_PAUSE); });
  for (int s = 16; s < 900; ++s) {
    clock_.at(std::chrono::seconds(s), [this] { EXPECT_FALSE(instrument_.on); });
  }
  clock_.at(900s, [this] {
    command(wire::COMMAND_CONTINUE);
    command(wire::COMMAND_CONTINUE);
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  ASSERT_EQ(outcome.pauses.size(), 1U);
  EXPECT_EQ(outcome.pauses[0].reason,
            "paused by a command of operator: 'ada@desk' (the output is off)");
  EXPECT_THAT(messages_,
              Contains("paused by a command of operator: 'ada@desk' (the output is off)"));
}

TEST_F(StepSequenceTest, AnAnalysisThatDiesInAPauseIsWaitedForFromThenOn) {
  clock_.at(4s, [this] { command(wire::COMMAND_PAUSE); });
  silent_between(400s, 400s + StepSequence::away_limit - 2s);
  clock_.at(600s, [this] { command(wire::COMMAND_CONTINUE); });
  EXPECT_EQ(conduct().problem, "");
}

TEST_F(StepSequenceTest, AnAbortEndsTheRunWithWhatThereIs) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] { command(wire::COMMAND_ABORT); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "ended by a command of operator: 'ada@desk'");
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_THAT(messages_, Contains("ended by a command of operator: 'ada@desk'"));
  EXPECT_LT(clock_.elapsed(), 18s);
  EXPECT_EQ(outcome.results.front().step, 1U);
}

TEST_F(StepSequenceTest, AnAbortBeforeTheFirstStepIsNoPause) {
  clock_.at(0s, [this] { command(wire::COMMAND_ABORT); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "ended by a command of operator: 'ada@desk'");
  EXPECT_THAT(excited_, IsEmpty());
  EXPECT_THAT(outcome.pauses, IsEmpty());
}

TEST_F(StepSequenceTest, AStopEndsAPauseAtOnce) {
  clock_.at(4s, [this] { command(wire::COMMAND_PAUSE); });
  clock_.at(20s, [this] { stop_.request_stop(); });
  const RunOutcome outcome = conduct();
  EXPECT_TRUE(outcome.interrupted);
  EXPECT_LT(clock_.elapsed(), 21s);
  EXPECT_FALSE(instrument_.on);
}

} // namespace
} // namespace dyncal::inline run
