// A recorded run evaluated again, where its messages came in an unusual order.
#include "services/replay/recorded_run.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"
#include "tests/unit/services/recording/example_recording.hpp"

namespace dyncal::services {
namespace {

class RecordedRun : public testing::Test {
protected:
  tests::TemporaryFolder folder_;
  tests::SyntheticRun synthetic_{.steps = {{"40", 10.0}}};
  std::vector<wire::SampleBlock> dau_ = synthetic_.dau_blocks();
  ExampleRecording recording_{folder_.path() / "run.mcap"};

  void SetUp() override {
    add_state(wire::MEASUREMENT_RUNNING);
    recording_.add("SourceDescription", synthetic_.acs_description());
    recording_.add("SourceDescription", synthetic_.dau_description());
    add_excitation(wire::EXCITATION_SETTLING);
  }
  void add_state(wire::MeasurementState state) {
    wire::Measurement measurement = synthetic_.measurement();
    measurement.state(state);
    recording_.add("Measurement", measurement);
  }
  void add_excitation(wire::ExcitationState state) {
    wire::Excitation excitation;
    excitation.bench(dau_.front().bench());
    excitation.run(synthetic_.measurement().run());
    excitation.step(1);
    excitation.state(state);
    recording_.add("Excitation", excitation);
  }
  void add_acs() {
    auto blocks = synthetic_.acs_blocks();
    blocks.front().acknowledged_run(synthetic_.measurement().run().to_string());
    for (const wire::SampleBlock& block : blocks) {
      recording_.add("AcsSamples", block);
    }
  }
  // Its answer to the run, long before the step.
  void add_early_dau_block() {
    wire::SampleBlock early = dau_.front();
    early.acknowledged_run(synthetic_.measurement().run().to_string());
    for (std::int64_t& stamp_ns : early.stamps_ns()) {
      stamp_ns -= 10'000'000'000; // more than the grace of a step
    }
    recording_.add("DauSamples", early);
  }
  RecordedRunOutcome evaluate() {
    EXPECT_TRUE(recording_.writer.close());
    auto reader = recording::RecordingReader::open(folder_.path() / "run.mcap");
    return evaluate_recording(*reader, {}, {}).value();
  }
};

TEST_F(RecordedRun, TakesNoStepForOverInASourceThatWasSilent) {
  add_early_dau_block();
  add_acs();
  add_excitation(wire::EXCITATION_DONE);
  for (wire::SampleBlock block : dau_) {
    block.session(block.session() + 1); // its service was started again
    block.received_utc_ns(block.received_utc_ns() + 1);
    recording_.add("DauSamples", block);
  }
  add_state(wire::MEASUREMENT_DONE);
  const RecordedRunOutcome recorded = evaluate();
  ASSERT_EQ(recorded.outcome.results.size(), 1U);
  EXPECT_TRUE(recorded.outcome.results[0].valid) << recorded.outcome.results[0].problem;
}

// As the live analysis: it waited for a description that the run can go by.
TEST_F(RecordedRun, LeavesOutASessionWhoseChannelsAreOthers) {
  add_early_dau_block();
  add_acs();
  wire::SourceDescription nameless = synthetic_.dau_description();
  nameless.session(nameless.session() + 1);
  for (wire::ChannelDescription& channel : nameless.channels()) {
    channel.name("data_" + channel.name());
  }
  recording_.add("SourceDescription", nameless);
  for (const std::uint64_t restarts : {1U, 2U}) {
    for (wire::SampleBlock block : dau_) {
      block.session(block.session() + restarts);
      block.received_utc_ns(block.received_utc_ns() + static_cast<std::int64_t>(restarts));
      recording_.add("DauSamples", block);
    }
    wire::SourceDescription whole = synthetic_.dau_description();
    whole.session(whole.session() + 2);
    recording_.add("SourceDescription", whole);
  }
  add_excitation(wire::EXCITATION_DONE);
  add_state(wire::MEASUREMENT_DONE);
  const RecordedRunOutcome recorded = evaluate();
  ASSERT_EQ(recorded.outcome.results.size(), 1U);
  EXPECT_TRUE(recorded.outcome.results[0].valid) << recorded.outcome.results[0].problem;
}

// The results of the steps are there, and the end of the run as it was recorded.
TEST_F(RecordedRun, EndsWithASourceThatSendsNothingMore) {
  add_early_dau_block();
  add_acs();
  add_excitation(wire::EXCITATION_DONE);
  add_state(wire::MEASUREMENT_DONE);
  const RecordedRunOutcome recorded = evaluate();
  ASSERT_EQ(recorded.outcome.results.size(), 1U);
  EXPECT_FALSE(recorded.outcome.results[0].valid);
}

} // namespace
} // namespace dyncal::services
