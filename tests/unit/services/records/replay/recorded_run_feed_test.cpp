#include "services/records/replay/recorded_run_feed.hpp"

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"
#include "tests/unit/services/records/mcap/example_recording.hpp"

namespace dyncal::inline records {
namespace {

// All steps are evaluated at the end: what was announced waits for a source that sends no more.
class RecordedRunFeedTest : public testing::Test {
protected:
  static constexpr std::size_t steps = 12;

  void SetUp() override {
    tests::SyntheticRun run{.steps = {}};
    for (std::size_t i = 0; i < steps; ++i) {
      run.steps.push_back({i % 2 == 0 ? "40" : "80", 10.0});
    }
    ExampleRecording recording(folder_.path() / "run.mcap");
    wire::Measurement measurement = run.measurement();
    measurement.state(wire::MEASUREMENT_RUNNING);
    recording.add("Measurement", measurement);
    recording.add("SourceDescription", run.acs_description());
    recording.add("SourceDescription", run.dau_description());
    add("AcsSamples", run.acs_blocks(), recording);
    add("DauSamples", run.dau_blocks(), recording);
    for (std::uint32_t step = 1; step <= steps; ++step) {
      wire::Excitation excitation;
      excitation.bench(measurement.bench());
      excitation.run(measurement.run());
      excitation.step(step);
      excitation.state(wire::EXCITATION_DONE);
      recording.add("Excitation", excitation);
    }
    measurement.state(wire::MEASUREMENT_DONE);
    recording.add("Measurement", measurement);
    ASSERT_TRUE(recording.writer.close());
  }
  static void add(const std::string& topic, std::vector<wire::SampleBlock> blocks,
                  ExampleRecording& recording) {
    for (wire::SampleBlock& block : blocks) {
      block.end_of_stream(false);
      recording.add(topic, block);
    }
  }
  void walk(bool gives_up) {
    auto reader = recording::RecordingReader::open(folder_.path() / "run.mcap").value();
    const RecordedRunIndex index = index_recording(reader, "", nullptr, {}).value();
    const Recipe recipe = parse_recipe(index.plan).value();
    outcome_ = outcome_of(recipe);
    RunEvaluator evaluator(recipe, {.evaluations_at_once = 2, .count = count_});
    RecordedRunFeed feed(reader, index, evaluator, outcome_);
    ASSERT_TRUE(reader.scan(
        {.message = [&](const recording::MessageInFile& message) { feed.take(message); }}));
    EXPECT_TRUE(outcome_.results.empty());
    if (gives_up) {
      evaluator.give_up();
    }
    ASSERT_TRUE(feed.finish(false));
  }

  tests::TemporaryFolder folder_;
  SharedWorkCount count_ = std::make_shared<WorkCount>("");
  RunOutcome outcome_;
};

TEST_F(RecordedRunFeedTest, EvaluatesEveryStepAtTheEnd) {
  walk(false);
  EXPECT_EQ(outcome_.results.size(), steps);
  EXPECT_EQ(outcome_.transfer_functions.size(), 1U);
}

TEST_F(RecordedRunFeedTest, EvaluatesNothingOnceTheRunIsGivenUp) {
  walk(true);
  EXPECT_TRUE(outcome_.results.empty());
  EXPECT_TRUE(outcome_.transfer_functions.empty());
  EXPECT_EQ(count_->state().total, steps);
  EXPECT_EQ(count_->state().done, 0U);
}

} // namespace
} // namespace dyncal::inline records
