// What a run at the analysis service makes of samples that had to be asked for. No real time
// passes.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include "tests/unit/services/programs/analysis/played_session.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

// Runs of which samples were lost, or that began before this service: the results are those of an
// undisturbed run, bit for bit.
class RunSessionCatchUp : public RunSessionTest {
protected:
  wire::Measurement synthetic_plan_ = synthetic_.measurement(); // that another service takes over

  static std::vector<std::string> bits_of(const std::vector<wire::CalibrationResult>& results) {
    std::vector<std::string> bits;
    bits.reserve(results.size());
    for (const wire::CalibrationResult& result : results) {
      bits.push_back(fmt::format("{} {:a} {:a} {:a} {:a} {} {}", result.valid(), result.magnitude(),
                                 result.u_magnitude(), result.phase_rad(), result.u_phase_rad(),
                                 result.lost(), result.flags().size()));
    }
    return bits;
  }
  // Of a source that goes on.
  static std::vector<wire::SampleBlock> endless(std::vector<wire::SampleBlock> blocks) {
    blocks.back().end_of_stream(false);
    return blocks;
  }
  // Another service takes the run over.
  void start_by_catching_up() {
    wire::Measurement running = synthetic_plan_;
    running.state(wire::MEASUREMENT_RUNNING);
    session_ = create(running, "analysis@test:2", SourceStreams::Begin::behind);
  }
  // All of the plan has been sent when this service takes the run over, and is sent again.
  void take_over_behind_the_last_step() {
    arm_and_run();
    acs_.send(endless(synthetic_.acs_blocks()));
    dau_.send(endless(synthetic_.dau_blocks()));
    session_.reset();
    start_by_catching_up();
    run_for(1s, {&acs_, &dau_});
    acs_.answer_requests();
    dau_.answer_requests();
  }
  void finish() {
    announce(wire::EXCITATION_DONE);
    set_state(wire::MEASUREMENT_DONE);
    for (int i = 0; i < 20 && !session_->finished(); ++i) {
      pass(100ms);
      acs_.answer_requests();
      dau_.answer_requests();
    }
    EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  }
  // At the end of the run, no more samples coming.
  void expect_the_step_without_value() {
    announce(wire::EXCITATION_DONE);
    set_state(wire::MEASUREMENT_DONE);
    for (int i = 0; i < 200 && !session_->finished(); ++i) {
      pass(100ms);
      acs_.send_nothing();
      dau_.send_nothing();
    }
    ASSERT_EQ(published_.results().size(), 1U);
    EXPECT_FALSE(published_.results()[0].valid());
  }
};

// The same run in a network of its own, with nothing lost.
class UndisturbedRun : public RunSessionCatchUp {
public:
  void TestBody() override {}
  std::vector<std::string> results() {
    arm_and_run();
    announce(wire::EXCITATION_SETTLING);
    acs_.send(synthetic_.acs_blocks());
    dau_.send(synthetic_.dau_blocks());
    finish();
    return bits_of(published_.results());
  }
};

TEST_F(RunSessionCatchUp, GivesTheSameResultWithBlocksThatHadToBeAskedFor) {
  const auto expected = UndisturbedRun().results();
  ASSERT_EQ(expected.size(), 1U);
  ASSERT_EQ(expected[0].substr(0, 4), "true");
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  acs_.send(synthetic_.acs_blocks());
  const auto blocks = synthetic_.dau_blocks();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (i % 3 == 1) {
      dau_.lose(blocks[i]);
    } else {
      dau_.send({blocks[i]});
    }
    pass(10ms);
  }
  EXPECT_EQ(dau_.answer_requests().size(), 1U);
  finish();
  EXPECT_EQ(bits_of(published_.results()), expected);
}

TEST_F(RunSessionCatchUp, GivesTheSameResultAfterALinkThatWasDownUntilTheEnd) {
  const auto expected = UndisturbedRun().results();
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  acs_.send(synthetic_.acs_blocks());
  for (const wire::SampleBlock& block : synthetic_.dau_blocks()) {
    dau_.lose(block);
  }
  announce(wire::EXCITATION_DONE);
  run_for(60s, {}); // the step has long been over, but its samples are on the way
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_TRUE(published_.results().empty());
  finish();
  EXPECT_EQ(bits_of(published_.results()), expected);
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
}

// The service has been started again, but its samples do not come through yet: how far it had come
// when the step was announced to be over is not known.
TEST_F(RunSessionCatchUp, TakesNoStepForOverInASourceThatIsSilent) {
  const auto blocks = synthetic_.dau_blocks();
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  acs_.send(synthetic_.acs_blocks());
  wire::SampleBlock early = blocks.front();
  for (std::int64_t& stamp_ns : early.stamps_ns()) {
    stamp_ns -= 10'000'000'000; // more than the grace of a step
  }
  dau_.send({early});
  run_for(2500ms, {});
  dau_.restart();
  describe(dau_);
  EXPECT_EQ(dau_.answer_requests().size(), 1U); // with nothing
  run_for(100ms, {});
  announce(wire::EXCITATION_DONE);
  run_for(500ms, {});
  for (const wire::SampleBlock& block : blocks) {
    dau_.send({block});
    run_for(100ms, {});
  }
  finish();
  ASSERT_EQ(published_.results().size(), 1U);
  EXPECT_TRUE(published_.results()[0].valid()) << published_.results()[0].problem();
}

// The service has been started again, and the descriptions of its sensor's channels are not there
// yet: what it sends meanwhile is not thrown away.
TEST_F(RunSessionCatchUp, WaitsForASourceThatComesBackWithOtherChannels) {
  const auto expected = UndisturbedRun().results();
  const wire::SourceDescription whole = dau_.description();
  wire::SourceDescription nameless = whole;
  for (wire::ChannelDescription& channel : nameless.channels()) {
    channel.name("data_" + channel.name());
  }
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  dau_.restart(nameless);
  describe(dau_);
  acs_.send(endless(synthetic_.acs_blocks()));
  dau_.send(endless(synthetic_.dau_blocks()));
  run_for(1s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_THAT(published_.newest_status().message(),
              testing::StartsWith("source 'dau' has no channel "));
  announce(wire::EXCITATION_DONE);
  run_for(10s, {&acs_, &dau_});
  EXPECT_TRUE(published_.results().empty());
  sources_[dau_.name()].description->channels(whole.channels()); // of the same session
  run_for(1s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  finish();
  EXPECT_EQ(bits_of(published_.results()), expected);
}

TEST_F(RunSessionCatchUp, TakesNothingOfASourceThatComesBackWithAnotherBenchFile) {
  wire::PlannedSource planned;
  planned.source("dau");
  planned.settings("sensor = 1\n");
  wire::Measurement measurement = synthetic_.measurement();
  measurement.sources().push_back(planned);
  session_ = create(measurement);
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  acs_.send(endless(synthetic_.acs_blocks()));
  const wire::SourceDescription before = dau_.description();
  wire::SourceDescription other = before;
  other.settings("sensor = 2\n");
  dau_.restart(other);
  describe(dau_);
  dau_.send(endless(synthetic_.dau_blocks()));
  run_for(1s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_THAT(published_.newest_status().message(),
              testing::HasSubstr("key 'sources.dau.sensor' is 2 there and 1 here"));
  EXPECT_TRUE(published_.results().empty());
  dau_.restart(before); // with the right one
  describe(dau_);
  run_for(1s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  expect_the_step_without_value(); // its samples were those of another sensor
}

// Another sensor has been mounted; then the one that the run began with is put back.
TEST_F(RunSessionCatchUp, TakesNothingOfAnotherInstrument) {
  wire::SourceDescription before = dau_.description();
  before.serial("1");
  dau_.restart(before);
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  acs_.send(endless(synthetic_.acs_blocks()));
  for (const bool same_session : {false, true}) {
    wire::SourceDescription other = before;
    other.serial("2");
    if (same_session) {
      other.session(dau_.description().session());
      sources_[dau_.name()].description = other;
    } else {
      dau_.restart(other);
      describe(dau_);
    }
    run_for(1s, {&acs_, &dau_});
    dau_.send(endless(synthetic_.dau_blocks()));
    run_for(1s, {&acs_, &dau_});
    EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
    EXPECT_THAT(published_.newest_status().message(),
                testing::HasSubstr("is another instrument than the run began with: now "));
    dau_.restart(before);
    describe(dau_);
    run_for(1s, {&acs_, &dau_});
    EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  }
  expect_the_step_without_value(); // its samples were those of another sensor
}

// A program that sends and never says what.
TEST_F(RunSessionCatchUp, LeavesOutASessionThatIsNotDescribedAndNamesIt) {
  const wire::SourceDescription before = dau_.description();
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  acs_.send(endless(synthetic_.acs_blocks()));
  dau_.restart(before);
  dau_.send(endless(synthetic_.dau_blocks()));
  run_for(SourceStreams::session_limit - 1s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  run_for(2s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_THAT(published_.newest_status().message(),
              testing::StartsWith("source 'dau' of bench 'synthetic' sends samples of a session "
                                  "that it has not described"));
  dau_.restart(before); // and now it does
  describe(dau_);
  run_for(1s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  expect_the_step_without_value();
}

TEST_F(RunSessionCatchUp, WaitsForADescriptionThatComesLate) {
  const auto expected = UndisturbedRun().results();
  const wire::SourceDescription before = dau_.description();
  arm_and_run();
  announce(wire::EXCITATION_SETTLING);
  acs_.send(endless(synthetic_.acs_blocks()));
  dau_.restart(before);
  dau_.send(endless(synthetic_.dau_blocks()));
  run_for(3s, {&acs_, &dau_});
  describe(dau_);
  run_for(1s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  announce(wire::EXCITATION_DONE);
  run_for(1s, {&acs_, &dau_});
  finish();
  EXPECT_EQ(bits_of(published_.results()), expected);
}

// ---- resumed by who does not have the run's bench

class ResumedSession : public RunSessionCatchUp {
protected:
  bus::Reader<wire::Command> commands_ =
      participant_.reader(bus::topics::command, tests::played_bench, nullptr).value();

  void hear_from(const std::string& conductor, const std::string& recipe = "") {
    wire::Measurement measurement = synthetic_.measurement();
    measurement.state(wire::MEASUREMENT_RUNNING);
    measurement.conductor(conductor);
    if (!recipe.empty()) {
      measurement.recipe_sha256(recipe);
    }
    session_->update(measurement);
    work();
  }
  std::size_t asked_to_end() {
    std::size_t times = 0;
    commands_.take([&](const wire::Command& command) {
      if (command.target().to_string() == "conductor") {
        ++times;
        EXPECT_EQ(command.kind(), wire::COMMAND_ABORT);
        EXPECT_EQ(command.run(), tests::played_run);
        EXPECT_EQ(command.sender(), "analysis@test:1");
      }
    });
    return times;
  }
  void run_as(const std::string& conductor, std::chrono::milliseconds time) {
    for (; time > 0ms; time -= 100ms) {
      clock_.advance(100ms);
      hear_from(conductor);
      acs_.send_nothing();
      dau_.send_nothing();
      work();
    }
  }
};

TEST_F(ResumedSession, AsksItsConductorToEndWhereTheInstrumentIsAnother) {
  wire::SourceDescription before = dau_.description();
  before.serial("1");
  dau_.restart(before);
  arm();
  run_as("lab-1:7", 1s);
  wire::SourceDescription other = before;
  other.serial("2");
  dau_.restart(other);
  describe(dau_);
  run_as("lab-1:7", 2s);
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_EQ(asked_to_end(), 0U) << "who conducts it may put the other one back";
  run_as("lab-2:9", 3s);
  EXPECT_GE(asked_to_end(), 2U) << "one may be lost";
  dau_.restart(before);
  describe(dau_);
  run_as("lab-3:9", 3s);
  EXPECT_EQ(asked_to_end(), 0U) << "an honest resume";
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  dau_.restart(other);
  describe(dau_);
  run_as("lab-3:9", 3s);
  EXPECT_EQ(asked_to_end(), 0U) << "it is waited for";
}

TEST_F(ResumedSession, AsksWhoHasAnotherRecipeToEndUnlessItsConductorLives) {
  arm();
  run_as("lab-1:7", 1s);
  hear_from("lab-2:9", "other");
  EXPECT_EQ(asked_to_end(), 0U) << "two of one name";
  clock_.advance(RunSession::bench_limit + 1ms);
  hear_from("lab-2:9", "other");
  EXPECT_EQ(asked_to_end(), 1U);
  hear_from("lab-2:9");
  EXPECT_EQ(asked_to_end(), 0U) << "now it has that of the run";
}

// A description that is completed, or comes again from a service that was restarted, is no other.
TEST_F(RunSessionCatchUp, GoesOnWithAnInstrumentThatDescribesItselfAgain) {
  wire::SourceDescription whole = dau_.description();
  whole.device("MPU-9250");
  whole.serial("1");
  dau_.restart(whole);
  arm_and_run();
  for (const char* device : {"", "MPU-9250"}) {
    wire::SourceDescription again = whole;
    again.device(device);
    again.firmware("2");
    dau_.restart(again);
    describe(dau_);
    run_for(1s, {&acs_, &dau_});
    EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  }
}

TEST_F(RunSessionCatchUp, GivesTheSameResultOfARunThatBeganBeforeIt) {
  const auto expected = UndisturbedRun().results();
  arm_and_run();
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  session_.reset(); // died
  start_by_catching_up();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  work();
  acs_.send_nothing();
  work();
  finish();
  EXPECT_EQ(published_.newest_status().service().to_string(), "analysis@test:2");
  EXPECT_EQ(bits_of(published_.results()), expected);
}

// Whoever resumes the run excites what has no result: it must not look before there is one.
TEST_F(RunSessionCatchUp, IsNotReadyBeforeTheResultsOfARunThatBeganBeforeIt) {
  arm_and_run();
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  session_.reset(); // died, and the conductor with it: nothing is announced
  start_by_catching_up();
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  run_for(1500ms, {});
  acs_.answer_requests();
  run_for(1500ms, {});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_THAT(published_.newest_status().message(), testing::StartsWith("taking the run over; "));
  EXPECT_TRUE(published_.results().empty());
  dau_.answer_requests();
  run_for(100ms, {});
  for (const wire::ServiceStatus& status : published_.statuses()) {
    if (status.service().to_string() == "analysis@test:2" && status.health() == wire::HEALTH_OK) {
      EXPECT_EQ(status.results_published(), 1U);
    }
  }
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  EXPECT_EQ(published_.results().size(), 1U);
}

// Analysis and conductor died after the last step, and somebody resumes the run: only that one
// knows whether a step is excited again, and needs an analysis that has not ended it.
TEST_F(RunSessionCatchUp, EndsNoRunThatItHasTakenOverBeforeItsConductorDoes) {
  take_over_behind_the_last_step();
  run_for(RunSession::announcement_limit - 2s, {&acs_, &dau_});
  EXPECT_EQ(published_.results().size(), 1U);
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  set_state(wire::MEASUREMENT_DONE);
  pass(200ms);
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  EXPECT_EQ(published_.results().size(), 1U);
}

TEST_F(RunSessionCatchUp, EndsRecordedFilesThatItHasTakenOverWithTheirLastStep) {
  take_over_behind_the_last_step();
  run_for(RunSession::announcement_limit + 3s, {&acs_, &dau_}); // and nobody announces a step
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  EXPECT_EQ(published_.results().size(), 1U);
}

TEST_F(RunSessionCatchUp, SaysWhichSourceIsAwayWhileItTakesARunOver) {
  arm_and_run();
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  session_.reset();
  start_by_catching_up();
  run_for(1s, {&acs_});
  acs_.answer_requests();
  run_for(6s, {&acs_}); // and nothing of the other
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_EQ(published_.newest_status().message(),
            "source 'dau' of bench 'synthetic' has sent nothing for 5 s");
  run_for(RunSession::patience + 2s, {&acs_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_FAILED);
}

TEST_F(RunSessionCatchUp, IsNotReadyWhileASourceIsMissingOrHasAnotherBenchFile) {
  wire::PlannedSource planned;
  planned.source("dau");
  planned.settings("sensor = 1\n");
  synthetic_plan_.sources().push_back(planned);
  arm_and_run();
  acs_.send(endless(synthetic_.acs_blocks()));
  dau_.send(endless(synthetic_.dau_blocks()));
  session_.reset(); // died, and the DAU with it
  sources_.erase(dau_.name());
  start_by_catching_up();
  for (int i = 0; i < 30; ++i) {
    run_for(100ms, {&acs_});
    acs_.answer_requests();
    EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  }
  EXPECT_EQ(published_.newest_status().message(),
            "source 'dau' of bench 'synthetic' is not on the network");
  wire::SourceDescription other = dau_.description();
  other.settings("sensor = 2\n");
  dau_.restart(other);
  describe(dau_);
  run_for(3s, {&acs_, &dau_});
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_THAT(published_.newest_status().message(),
              testing::HasSubstr("key 'sources.dau.sensor' is 2 there and 1 here"));
  EXPECT_TRUE(published_.results().empty());
}

TEST_F(RunSessionCatchUp, RefusesARunOfWhichASourceHasTheBeginningNoMore) {
  arm_and_run();
  dau_.forget_what_was_sent();
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  session_.reset(); // died
  start_by_catching_up();
  work();
  acs_.answer_requests();
  dau_.answer_requests();
  work();
  EXPECT_EQ(arm_state(), wire::ARM_REFUSED);
  EXPECT_THAT(published_.newest_status().message(),
              testing::StartsWith("source 'dau' of bench 'synthetic' no longer has what it sent"));
  EXPECT_TRUE(published_.results().empty()); // in place of what the other had found
}

} // namespace
} // namespace dyncal::inline programs
