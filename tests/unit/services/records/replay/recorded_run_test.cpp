// A recorded run evaluated again, where its messages came in an unusual order.
#include "services/records/replay/recorded_run.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"
#include "tests/unit/services/records/mcap/example_recording.hpp"

namespace dyncal::inline records {
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
    add_early_dau_block();
    add_acs();
  }
  void add_state(wire::MeasurementState state) {
    wire::PlannedSource planned;
    planned.source("dau");
    planned.settings("sensor = 1\n");
    wire::Measurement measurement = synthetic_.measurement();
    measurement.sources().push_back(planned);
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
  void add_description(wire::SourceDescription description, std::uint64_t restarts) {
    description.session(description.session() + restarts);
    recording_.add("SourceDescription", description);
  }
  // What its service sent after it had been started again, before anything else that is recorded:
  // only the last block came at once.
  void add_restarted_dau(std::uint64_t restarts) {
    for (wire::SampleBlock block : dau_) {
      const bool is_last = block.block() == dau_.back().block();
      block.session(block.session() + restarts);
      block.received_utc_ns(example_utc_ns +
                            (is_last ? std::int64_t{recording_.sequence} * 1'000'000 : 0));
      recording_.add("DauSamples", block);
    }
  }
  void expect_a_valid_result() {
    add_state(wire::MEASUREMENT_DONE);
    const RecordedRunOutcome recorded = evaluate();
    ASSERT_EQ(recorded.outcome.results.size(), 1U);
    EXPECT_TRUE(recorded.outcome.results[0].valid) << recorded.outcome.results[0].problem;
  }
  RecordedRunOutcome evaluate() {
    EXPECT_TRUE(recording_.writer.close());
    auto reader = recording::RecordingReader::open(folder_.path() / "run.mcap");
    return evaluate_recording(*reader, {}, {}).value();
  }
};

TEST_F(RecordedRun, TakesNoStepForOverInASourceThatWasSilent) {
  add_excitation(wire::EXCITATION_DONE);
  add_description(synthetic_.dau_description(), 1);
  add_restarted_dau(1);
  expect_a_valid_result();
}

// Another session's description says nothing of its samples.
TEST_F(RecordedRun, LeavesOutASessionThatIsNotDescribed) {
  add_restarted_dau(1);
  add_description(synthetic_.dau_description(), 2);
  add_restarted_dau(2);
  add_excitation(wire::EXCITATION_DONE);
  expect_a_valid_result();
}

TEST_F(RecordedRun, HasNoResultOfASessionThatIsNotDescribed) {
  add_restarted_dau(1);
  add_excitation(wire::EXCITATION_DONE);
  add_state(wire::MEASUREMENT_DONE);
  const RecordedRunOutcome recorded = evaluate();
  ASSERT_EQ(recorded.outcome.results.size(), 1U);
  EXPECT_FALSE(recorded.outcome.results[0].valid);
}

// As the live analysis: it waited for a description that the run can go by.
TEST_F(RecordedRun, LeavesOutASessionWhoseChannelsAreOthers) {
  wire::SourceDescription nameless = synthetic_.dau_description();
  for (wire::ChannelDescription& channel : nameless.channels()) {
    channel.name("data_" + channel.name());
  }
  add_description(nameless, 1);
  add_restarted_dau(1);
  add_description(synthetic_.dau_description(), 2);
  add_restarted_dau(2);
  add_excitation(wire::EXCITATION_DONE);
  expect_a_valid_result();
}

TEST_F(RecordedRun, LeavesOutASessionOfAnotherBenchFile) {
  wire::SourceDescription other = synthetic_.dau_description();
  other.settings("sensor = 2\n");
  add_description(other, 1);
  add_restarted_dau(1);
  add_excitation(wire::EXCITATION_DONE);
  add_state(wire::MEASUREMENT_DONE);
  const RecordedRunOutcome recorded = evaluate();
  ASSERT_EQ(recorded.outcome.results.size(), 1U);
  EXPECT_FALSE(recorded.outcome.results[0].valid); // its samples were those of another sensor
}

// The results of the steps are there, and the end of the run as it was recorded.
TEST_F(RecordedRun, EndsWithASourceThatSendsNothingMore) {
  add_excitation(wire::EXCITATION_DONE);
  add_state(wire::MEASUREMENT_DONE);
  const RecordedRunOutcome recorded = evaluate();
  ASSERT_EQ(recorded.outcome.results.size(), 1U);
  EXPECT_FALSE(recorded.outcome.results[0].valid);
}

// The recorder was started again when the step was over: everything is stored behind that.
class RecordingBegunAgain : public RecordedRun {
protected:
  void SetUp() override {
    add_excitation(wire::EXCITATION_DONE); // kept for whoever comes late, as the run itself
    add_state(wire::MEASUREMENT_RUNNING);
    recording_.add("SourceDescription", synthetic_.acs_description());
    recording_.add("SourceDescription", synthetic_.dau_description());
  }
  // What was sent a minute ago, and one block of now, which tells how far the clocks are apart.
  void add_given_again(const std::string& topic, std::vector<wire::SampleBlock> blocks) {
    blocks.front().acknowledged_run(synthetic_.measurement().run().to_string());
    for (wire::SampleBlock& block : blocks) {
      const auto order_ns = static_cast<std::int64_t>(block.block());
      block.received_utc_ns(example_utc_ns - 60'000'000'000 + order_ns);
      recording_.add(topic, block);
    }
    wire::SampleBlock now = blocks.back();
    now.block(now.block() + 1);
    now.first_sample(now.first_sample() + now.sample_count());
    for (std::int64_t& stamp_ns : now.stamps_ns()) {
      stamp_ns += 60'000'000'000;
    }
    now.received_utc_ns(example_utc_ns + std::int64_t{recording_.sequence} * 1'000'000);
    recording_.add(topic, now);
  }
  // Its answer to the run long before the step.
  [[nodiscard]] std::vector<wire::SampleBlock> dau_blocks() const {
    std::vector<wire::SampleBlock> blocks{dau_.front()};
    for (std::int64_t& stamp_ns : blocks.front().stamps_ns()) {
      stamp_ns -= 10'000'000'000; // more than the grace of a step
    }
    for (wire::SampleBlock block : dau_) {
      block.block(block.block() + 1);
      block.first_sample(block.first_sample() + dau_.front().sample_count());
      blocks.push_back(block);
    }
    return blocks;
  }
};

TEST_F(RecordingBegunAgain, TakesNoStepForOverBeforeItsSamplesHaveCome) {
  add_given_again("AcsSamples", synthetic_.acs_blocks());
  add_given_again("DauSamples", dau_blocks());
  expect_a_valid_result();
}

} // namespace
} // namespace dyncal::inline records
