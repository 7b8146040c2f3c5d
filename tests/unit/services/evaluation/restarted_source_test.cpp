// A source that restarts right after a step: what it sent of the step before is not thrown away as
// long as another source is behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

class RestartedSource : public testing::Test {
protected:
  explicit RestartedSource(std::vector<tests::SyntheticStep> steps = {{"40", 10.0}})
      : run_{.steps = std::move(steps)} {}

  tests::SyntheticRun run_;
  RunEvaluator evaluator_{*parse_recipe(run_.measurement()), {.ahead = true}};
  std::vector<wire::SampleBlock> acs_ = run_.acs_blocks();
  std::vector<wire::SampleBlock> dau_ = run_.dau_blocks();
  std::vector<StepResult> results_;

  void SetUp() override {
    ASSERT_TRUE(tests::describe(evaluator_, run_.acs_description()));
    ASSERT_TRUE(tests::describe(evaluator_, run_.dau_description()));
  }
  void take() {
    for (StepResult& result : evaluator_.take_output().results) {
      results_.push_back(std::move(result));
    }
  }
  // A part of all blocks.
  void feed(const std::vector<wire::SampleBlock>& blocks, double from, double to) {
    const auto count = static_cast<double>(blocks.size());
    for (auto i = static_cast<std::size_t>(from * count); i < static_cast<std::size_t>(to * count);
         ++i) {
      tests::feed(evaluator_, blocks[i]);
      take();
    }
  }
  // The blocks from there on are of a new session.
  void restart_dau(double from) {
    const auto first = static_cast<std::size_t>(from * static_cast<double>(dau_.size()));
    const std::uint64_t session = new_session();
    const std::uint64_t sample = dau_[first].first_sample();
    for (std::size_t i = first; i < dau_.size(); ++i) {
      dau_[i].session(session);
      dau_[i].block(i - first);
      dau_[i].first_sample(dau_[i].first_sample() - sample);
    }
  }
  static StepResult undisturbed(const tests::SyntheticRun& run) {
    RunEvaluator evaluator(*parse_recipe(run.measurement()));
    EXPECT_TRUE(tests::describe(evaluator, run.acs_description()));
    EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
    for (const auto& blocks : {run.acs_blocks(), run.dau_blocks()}) {
      for (const wire::SampleBlock& block : blocks) {
        tests::feed(evaluator, block);
      }
    }
    return evaluator.take_output().results.at(0);
  }
  [[nodiscard]] std::uint64_t new_session() const { return dau_.front().session() + 1; }
};

// The step lasts from 0.5 s to 2 s of 2.5 s.
TEST_F(RestartedSource, IsWaitedWithUntilTheOtherSourceHasSentTheStep) {
  feed(acs_, 0.0, 0.5);
  feed(dau_, 0.0, 0.78); // all planned samples, and not the end of the excitation
  EXPECT_FALSE(evaluator_.is_ready_for("dau", new_session()));
  EXPECT_TRUE(evaluator_.is_ready_for("dau", dau_.front().session()));
  EXPECT_TRUE(results_.empty());
  feed(acs_, 0.5, 1.0);
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_TRUE(evaluator_.is_ready_for("dau", new_session()));
  EXPECT_TRUE(to_message(Recipe{}, results_[0]) == to_message(Recipe{}, undisturbed(run_)));
}

// What the new session has of the step is evaluated, and the result says that it is not all.
TEST_F(RestartedSource, InTheMiddleOfAStepMakesItShorterThanPlanned) {
  feed(acs_, 0.0, 0.5);
  feed(dau_, 0.0, 0.5);
  restart_dau(0.52); // what it lacks was never sent
  feed(dau_, 0.52, 1.0);
  feed(acs_, 0.5, 1.0);
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_TRUE(results_[0].valid) << results_[0].problem;
  ASSERT_EQ(results_[0].flags.size(), 1U);
  EXPECT_EQ(results_[0].flags[0].sentence, "dau: shorter than planned");
  EXPECT_TRUE(may_be_cured(results_[0].flags[0].kind));
  const StepResult whole = undisturbed(run_);
  EXPECT_GT(results_[0].u_magnitude, whole.u_magnitude);
  EXPECT_NEAR(results_[0].magnitude, whole.magnitude, 5 * results_[0].u_magnitude);
}

// Too little of it is left to be found: then the restart is the cause that is named.
TEST_F(RestartedSource, AtTheEndOfAStepIsNamedWhereNothingIsLeft) {
  feed(acs_, 0.0, 0.5);
  feed(dau_, 0.0, 0.5);
  restart_dau(0.9);
  feed(dau_, 0.9, 1.0);
  feed(acs_, 0.5, 1.0);
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_FALSE(results_[0].valid);
  EXPECT_THAT(results_[0].problem, testing::HasSubstr("source 'dau' restarted during the run"));
}

class RestartedBetweenEqualSteps : public RestartedSource {
protected:
  RestartedBetweenEqualSteps() : RestartedSource({{"40", 10.0}, {"40", 10.0}}) {}
};

// However often it is asked while the new session waits.
TEST_F(RestartedBetweenEqualSteps, GivesTheSecondNotTheSamplesOfTheFirst) {
  feed(acs_, 0.0, 0.2);
  feed(dau_, 0.0, 0.4); // all planned samples of the first of 2 s, and not the end
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(evaluator_.is_ready_for("dau", new_session()));
    take();
  }
  feed(acs_, 0.2, 0.5);
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_TRUE(results_[0].valid) << results_[0].problem;
  EXPECT_TRUE(evaluator_.is_ready_for("dau", new_session()));
  restart_dau(0.95); // behind the second
  feed(acs_, 0.5, 1.0);
  feed(dau_, 0.95, 1.0);
  ASSERT_EQ(results_.size(), 2U);
  EXPECT_FALSE(results_[1].valid);
  EXPECT_THAT(results_[1].problem, testing::HasSubstr("source 'dau' restarted during the run"));
}

TEST_F(RestartedSource, IsNotWaitedWithBeforeAStepHasCome) {
  feed(acs_, 0.0, 0.5);
  feed(dau_, 0.0, 0.5);
  EXPECT_TRUE(evaluator_.is_ready_for("dau", new_session()));
  EXPECT_TRUE(results_.empty());
}

TEST_F(RestartedSource, IsNotWaitedWithWhenItIsNotOfTheRun) {
  EXPECT_TRUE(evaluator_.is_ready_for("can", new_session()));
}

} // namespace
} // namespace dyncal::inline evaluation
