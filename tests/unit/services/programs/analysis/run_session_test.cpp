// Every limit of a run at the analysis service: just before it nothing happens, just after it the
// right thing, with the right sentence. No real time passes.
#include "services/programs/analysis/run_session.hpp"

#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/programs/analysis/played_session.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tests::PlayedSource;

TEST_F(RunSessionTest, ArmsWhenEverySourceHasAnsweredInItsStream) {
  EXPECT_EQ(arm_state(), wire::ARM_WAITING);
  describe(acs_);
  describe(dau_);
  work();
  EXPECT_EQ(acs_.answer_commands(), 2U); // commands to all sources of the bench
  work();
  EXPECT_EQ(arm_state(), wire::ARM_WAITING);
  EXPECT_EQ(dau_.answer_commands(), 2U);
  work();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  EXPECT_EQ(published_.newest_status().service().to_string(), "analysis@test:1");
  EXPECT_EQ(published_.newest_status().dds(), "memory");
}

TEST_F(RunSessionTest, RepeatsItsCommandEvery100MillisecondsUntilItIsAnswered) {
  describe(acs_);
  describe(dau_);
  work();
  EXPECT_EQ(acs_.answer_commands(), 2U);
  clock_.advance(100ms - 1ns);
  work();
  EXPECT_EQ(dau_.answer_commands(), 2U);
  clock_.advance(1ns);
  work();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  EXPECT_EQ(dau_.answer_commands(), 0U);
}

TEST_F(RunSessionTest, ArmsAlthoughTheFirstCommandsAndTheFirstAnswerAreLost) {
  int lost = 0;
  network_.lose([&](const bus::MessageInTransit& message) {
    const bool first_commands =
        message.topic == bus::topics::command && message.receiver == "dau" && message.number < 4;
    const bool first_answer = message.topic == bus::topics::acs_samples && message.number == 0;
    lost += first_commands || first_answer ? 1 : 0;
    return first_commands || first_answer;
  });
  describe(acs_);
  describe(dau_);
  for (int i = 0; i < 30 && arm_state() != wire::ARM_ARMED; ++i) {
    work();
    acs_.answer_commands();
    dau_.answer_commands();
    clock_.advance(100ms);
  }
  EXPECT_GE(lost, 3);
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  EXPECT_LT(clock_.elapsed(), Arming::limit);
}

class RunSessionArming : public RunSessionTest, public testing::WithParamInterface<int> {
protected:
  struct Case {
    bool described;
    std::optional<wire::SourceState> state;
    std::string sentence;
    std::chrono::seconds limit = Arming::limit;
  };
  // What keeps the DAU from being armed.
  static Case case_of(int number) {
    switch (number) {
    case 0:
      return {false, std::nullopt, "source 'dau' of bench 'synthetic' is not on the network"};
    case 1:
      return {true, wire::SOURCE_SILENT, "source 'dau' of bench 'synthetic' is silent: no packets"};
    case 2:
      return {true, wire::SOURCE_FAILED, "source 'dau' of bench 'synthetic' is silent: no packets"};
    case 3:
      return {false, wire::SOURCE_STARTING,
              "source 'dau' of bench 'synthetic' has not described its channels yet: no packets",
              Arming::present_limit};
    default:
      return {true, wire::SOURCE_RUNNING,
              "source 'dau' of bench 'synthetic' does not answer in its sample stream",
              Arming::present_limit};
    }
  }
};

INSTANTIATE_TEST_SUITE_P(EveryCause, RunSessionArming, testing::Range(0, 5));

TEST_P(RunSessionArming, IsRefusedJustAfterItsLimitWithTheCause) {
  const Case one = case_of(GetParam());
  describe(acs_);
  if (one.described) {
    describe(dau_);
  }
  if (one.state) {
    report(dau_, *one.state, "no packets");
  }
  work();
  acs_.answer_commands();
  pass(RunSession::notice_after);
  EXPECT_EQ(published_.newest_status().message(), "");
  pass(one.limit - RunSession::notice_after);
  EXPECT_EQ(arm_state(), wire::ARM_WAITING);
  EXPECT_THAT(published_.newest_status().message(), testing::StartsWith(one.sentence));
  EXPECT_FALSE(session_->finished());
  clock_.advance(1ns);
  work();
  EXPECT_TRUE(session_->finished());
  const auto status = published_.newest_status();
  EXPECT_EQ(status.arm(), wire::ARM_REFUSED);
  EXPECT_EQ(status.health(), wire::HEALTH_FAILED);
  EXPECT_THAT(status.message(), testing::StartsWith(one.sentence));
}

TEST_F(RunSessionTest, ArmsWithASourceThatComesJustBeforeTheLimit) {
  describe(acs_);
  work();
  acs_.answer_commands();
  clock_.advance(Arming::limit - 300ms);
  work();
  describe(dau_);
  work();
  clock_.advance(300ms);
  work();
  dau_.answer_commands();
  work();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

TEST_F(RunSessionTest, ArmsWithASourceThatWasRestartedMeanwhile) {
  describe(acs_);
  report(dau_, wire::SOURCE_STARTING, "no packets");
  work();
  acs_.answer_commands();
  clock_.advance(Arming::present_limit - 1s);
  work();
  EXPECT_EQ(arm_state(), wire::ARM_WAITING);
  describe(dau_);
  work();
  clock_.advance(Arming::limit - 1s);
  work();
  dau_.answer_commands();
  work();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

TEST_F(RunSessionTest, RefusesARecipeThatItCannotEvaluateAtOnce) {
  wire::Measurement without_steps = synthetic_.measurement();
  without_steps.run("r2");
  without_steps.steps().clear();
  const auto session = create(without_steps);
  EXPECT_TRUE(session->finished());
  EXPECT_EQ(published_.newest_status().run().to_string(), "r2");
  EXPECT_EQ(published_.newest_status().arm(), wire::ARM_REFUSED);
  EXPECT_NE(published_.newest_status().message(), "");
  session->work(sources_); // does nothing
  wire::Measurement running = without_steps;
  running.state(wire::MEASUREMENT_DONE);
  session->update(running);
  session->announce({});
  EXPECT_EQ(published_.newest_status().arm(), wire::ARM_REFUSED);
}

class RunSessionBenchFile : public RunSessionTest {
protected:
  // Sources answer whose services have read this of their bench file, for a run of another one.
  void arm_with(const std::string& settings_of_service, const std::string& settings_of_run) {
    wire::Measurement measurement = synthetic_.measurement();
    wire::PlannedSource planned;
    planned.source("dau");
    planned.settings(settings_of_run);
    measurement.sources().push_back(planned);
    session_ = create(measurement);
    describe(acs_);
    describe(dau_);
    sources_["dau"].description->settings(settings_of_service);
    sources_["dau"].description->host("lab-2");
    work();
    acs_.answer(tests::played_run);
    dau_.answer(tests::played_run);
    work();
  }
};

TEST_F(RunSessionBenchFile, RefusesASourceWithAnotherSensorAtOnce) {
  arm_with("driver = 'smartup'\nsensor = '0xbccb0100'\n",
           "driver = 'smartup'\nsensor = '0xdeadbeef'\n");
  EXPECT_EQ(arm_state(), wire::ARM_REFUSED);
  EXPECT_THAT(published_.newest_status().message(),
              HasSubstr("source 'dau' of bench 'synthetic' on lab-2 has read another bench file "
                        "than this run: key 'sources.dau.sensor' is '0xbccb0100' there and "
                        "'0xdeadbeef' here"));
}

TEST_F(RunSessionBenchFile, ArmsASourceWithTheSameSettings) {
  arm_with("sensor = '0xbccb0100'\n", "sensor = '0xbccb0100'\n");
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

TEST_F(RunSessionBenchFile, ArmsASourceThatDoesNotTellItsSettings) {
  arm_with("", "sensor = '0xbccb0100'\n");
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

TEST_F(RunSessionTest, RefusesASourceThatLacksAChannelAtOnce) {
  wire::SourceDescription without_sync = acs_.description();
  without_sync.channels().resize(1);
  sources_["acs"].description = without_sync;
  work();
  EXPECT_EQ(arm_state(), wire::ARM_REFUSED);
  EXPECT_THAT(published_.newest_status().message(), HasSubstr("sync"));
}

TEST_F(RunSessionTest, WaitsForASourceThatIsSilentJustAfterItsLimitAndGoesOnWithIt) {
  arm_and_run();
  run_for(1s, {&acs_, &dau_});
  run_for(RunSession::silence_limit, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  clock_.advance(1ns);
  work();
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_EQ(published_.newest_status().message(),
            "source 'dau' of bench 'synthetic' has sent nothing for 5 s");
  run_for(60s, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  dau_.answer_requests();
  run_for(100ms, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  EXPECT_EQ(published_.newest_status().message(), "");
}

TEST_F(RunSessionTest, FailsARunWhoseSourceIsSilentBeyondItsPatience) {
  arm_and_run();
  run_for(1s, {&acs_, &dau_});
  run_for(RunSession::silence_limit + 100ms, {&acs_});
  run_for(RunSession::patience, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  run_for(100ms, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_FAILED);
  EXPECT_EQ(published_.newest_status().message(),
            "source 'dau' of bench 'synthetic' has sent nothing for 5 s, and nothing more for "
            "120 s");
  EXPECT_FALSE(session_->finished()); // the runner aborts it
  // The first cause explains the others.
  run_for(2 * RunSession::silence_limit, {});
  EXPECT_THAT(published_.newest_status().message(), HasSubstr("source 'dau'"));
}

TEST_F(RunSessionTest, DoesNotTakeItsOwnAbsenceForTheSilenceOfOthers) {
  arm_and_run();
  run_for(1s, {&acs_, &dau_});
  clock_.advance(RunSession::runner_limit + 60s); // stopped, or without the processor
  work();
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  run_for(RunSession::silence_limit, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  run_for(200ms, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
}

TEST_F(RunSessionTest, FailsARunWhoseSourceHasATwin) {
  arm_and_run();
  wire::SourceDescription other = acs_.description();
  other.session(other.session() + 1);
  PlayedSource twin(network_, other, "another host");
  for (int turn = 0; turn < 2; ++turn) {
    EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
    run_for(100ms, {&acs_, &dau_});
    run_for(100ms, {&twin, &dau_});
  }
  run_for(100ms, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_FAILED);
  EXPECT_EQ(published_.newest_status().message(),
            "two services send as source 'acs' of bench 'synthetic'; end one of them, or give it "
            "another name");
}

TEST_F(RunSessionTest, DoesNotTakeBlocksThatNameAnotherBench) {
  arm_and_run();
  run_for(1s, {&acs_, &dau_});
  session_->announce({});
  bus::Participant other = network_.join("other");
  auto writer = other
                    .writer<wire::SampleBlock>(bus::topics::dau_samples, bus::Profile::samples,
                                               tests::played_bench)
                    .value();
  wire::SampleBlock last;
  last.bench("b3");
  last.source("dau");
  last.session(dau_.description().session());
  last.block(11); // behind the answer and ten empty blocks
  last.end_of_stream(true);
  writer.write(last);
  work();
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  dau_.end_stream();
  work();
  EXPECT_NE(published_.newest_status().health(), wire::HEALTH_OK) << "else nothing was tried";
}

TEST_F(RunSessionTest, DoesNotWatchSourcesBeforeTheRunBegins) {
  arm();
  clock_.advance(2 * RunSession::silence_limit);
  work();
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
}

TEST_F(RunSessionTest, FailsARunWhoseSourceEndsBetweenItsSteps) {
  arm_and_run();
  session_->announce({});
  run_for(1s, {&acs_, &dau_});
  dau_.end_stream();
  work();
  EXPECT_EQ(published_.newest_status().message(),
            "source 'dau' of bench 'synthetic' has ended before the run");
}

TEST_F(RunSessionTest, LetsRecordedSourcesEnd) {
  arm_and_run();
  dau_.end_stream();
  work();
  run_for(2 * RunSession::silence_limit, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
}

TEST_F(RunSessionTest, FinishesAtOnceWhenAFailedRunIsAborted) {
  arm_and_run();
  pass(RunSession::silence_limit + 1ns);
  ASSERT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  pass(RunSession::patience + 1ns);
  ASSERT_EQ(published_.newest_status().health(), wire::HEALTH_FAILED);
  set_state(wire::MEASUREMENT_ABORTED);
  work();
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
}

TEST_F(RunSessionTest, EndsWithWhatThereIsWhenTheRunnerIsLost) {
  arm_and_run();
  pass(RunSession::runner_limit);
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  clock_.advance(1ns);
  work();
  work();
  EXPECT_TRUE(session_->finished());
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
}

TEST_F(RunSessionTest, EndsWithWhatThereIsWhenTheResultsOfADoneRunDoNotCome) {
  arm_and_run();
  run_for(1s, {&acs_, &dau_});
  set_state(wire::MEASUREMENT_DONE);
  work();
  for (auto waited = 0s; waited < RunSession::quiet_limit; waited += 2s) {
    pass(2s);
    set_state(wire::MEASUREMENT_DONE); // the runner is still there
    work();
    EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  }
  clock_.advance(1ns);
  work();
  work();
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  ASSERT_EQ(published_.results().size(), published_.newest_status().results_published());
  ASSERT_GE(published_.results().size(), 1U);
  for (const wire::CalibrationResult& result : published_.results()) {
    EXPECT_FALSE(result.valid());
    EXPECT_NE(result.problem(), "");
  }
}

TEST_F(RunSessionTest, PublishesWhatItEvaluatesAndCountsIt) {
  arm_and_run();
  session_->announce({});
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  set_state(wire::MEASUREMENT_DONE);
  work();
  work();
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  ASSERT_EQ(published_.results().size(), 1U);
  EXPECT_TRUE(published_.results()[0].valid()) << published_.results()[0].problem();
  EXPECT_NEAR(published_.results()[0].magnitude(), synthetic_.magnitude, 0.01);
  EXPECT_EQ(published_.transfer_functions().size(), 1U);
  EXPECT_EQ(published_.newest_status().results_published(), 1U);
  EXPECT_EQ(published_.newest_status().transfer_functions_published(), 1U);
  EXPECT_EQ(published_.newest_status().clock_reports_published(), 1U);
}

// In the same session, a block ahead each time: those of the source itself would be duplicates.
TEST_F(RunSessionTest, LeavesOutWhatAnotherProgramSendsAsASourceAndFlagsIt) {
  arm_and_run();
  session_->announce({});
  PlayedSource forger(network_, dau_.description(), "forger");
  forger.send_nothing(); // as the source has answered
  acs_.send(synthetic_.acs_blocks());
  const auto blocks = synthetic_.dau_blocks();
  ASSERT_GT(blocks.size(), 5U);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    wire::SampleBlock forged = blocks[i];
    for (double& value : forged.values()) {
      value *= 1.1;
    }
    forger.send({forged});
    work();
    dau_.send({blocks[i]});
    work();
  }
  set_state(wire::MEASUREMENT_DONE);
  work();
  work();
  ASSERT_EQ(published_.results().size(), 1U);
  const wire::CalibrationResult result = published_.results()[0];
  EXPECT_TRUE(result.valid()) << result.problem();
  EXPECT_NEAR(result.magnitude(), synthetic_.magnitude, 0.01);
  EXPECT_EQ(result.lost(), 0U);
  EXPECT_THAT(result.flag_names(), testing::Contains("two_writers"));
  EXPECT_THAT(result.flags(), testing::Contains("dau: another program sends in its name"));
}

TEST_F(RunSessionTest, LeavesOutSamplesFromBeforeASourcesAnswer) {
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  arm_and_run();
  run_for(1s, {&acs_, &dau_});
  set_state(wire::MEASUREMENT_DONE);
  work();
  pass(RunSession::quiet_limit + 1ns);
  work();
  ASSERT_EQ(published_.results().size(), 1U);
  EXPECT_FALSE(published_.results()[0].valid());
}

TEST_F(RunSessionTest, ReportsItsStatusEverySecond) {
  arm_and_run();
  const std::size_t before = published_.statuses().size();
  for (int i = 0; i < 50; ++i) {
    run_for(100ms, {&acs_, &dau_});
    static_cast<void>(published_.statuses()); // a reader of states holds the newest alone
  }
  EXPECT_EQ(published_.statuses().size() - before, 5U);
}

TEST_F(RunSessionTest, GivesAResultUpWhenItsWriterStaysFullAndGoesOn) {
  arm_and_run();
  session_->announce({});
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  set_state(wire::MEASUREMENT_DONE);
  network_.fill_writers(bus::topics::calibration_result);
  const auto before = clock_.elapsed();
  work();
  work();
  EXPECT_EQ(clock_.elapsed() - before, 10s);
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  EXPECT_TRUE(published_.results().empty());
  EXPECT_EQ(published_.newest_status().results_published(), 1U); // the runner sees one missing
}

TEST_F(RunSessionTest, IsHardlyHeldUpByAFullWriterOfCommands) {
  network_.fill_writers(bus::topics::command);
  describe(acs_);
  describe(dau_);
  work();
  EXPECT_EQ(clock_.elapsed(), 100ms); // 50 ms a command
  network_.empty_writers(bus::topics::command);
  clock_.advance(250ms);
  work();
  acs_.answer_commands();
  dau_.answer_commands();
  work();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

TEST_F(RunSessionTest, GivesALateJoinerItsStatusAndResults) {
  arm_and_run();
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  set_state(wire::MEASUREMENT_DONE);
  work();
  work();
  tests::PublishedByAnalysis late(network_, "late");
  EXPECT_EQ(late.newest_status().arm(), wire::ARM_FINISHED);
  EXPECT_EQ(late.results().size(), 1U);
  EXPECT_EQ(late.transfer_functions().size(), 1U);
  session_.reset();
  tests::PublishedByAnalysis too_late(network_, "too late");
  EXPECT_TRUE(too_late.results().empty());
}

class RunSessionLevel : public RunSessionTest {
protected:
  // Announces the step and sends samples of the reference until the health changes, or the stream
  // is about to end.
  wire::HealthState excite_at(double level_m_s2) {
    const tests::SyntheticRun excited{.steps = {{"40", level_m_s2}}};
    arm_and_run();
    announce(wire::EXCITATION_SETTLING);
    for (const wire::SampleBlock& block : excited.acs_blocks()) {
      if (block.end_of_stream()) {
        break;
      }
      acs_.send({block});
      work();
      if (published_.newest_status().health() != wire::HEALTH_OK) {
        break;
      }
      ++blocks_sent_;
    }
    return published_.newest_status().health();
  }
  std::size_t blocks_sent_ = 0;
};

TEST_F(RunSessionLevel, FailsTheRunWhenTheExciterIsDrivenFarAboveThePlan) {
  EXPECT_EQ(excite_at(500.0), wire::HEALTH_FAILED);
  EXPECT_THAT(published_.newest_status().message(),
              HasSubstr("where 10 m/s^2 are planned; the excitation is stopped"));
  EXPECT_LT(static_cast<double>(blocks_sent_),
            0.5 * static_cast<double>(synthetic_.acs_blocks().size()));
}

TEST_F(RunSessionLevel, GoesOnAtTheLevelThatIsPlanned) {
  EXPECT_EQ(excite_at(10.0), wire::HEALTH_OK);
  EXPECT_EQ(blocks_sent_, synthetic_.acs_blocks().size() - 1);
}

} // namespace
} // namespace dyncal::inline programs
