// A source that restarts right after a step: what it sent of the step before is not thrown away as
// long as another source is behind.
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::services {
namespace {

class RestartedSource : public testing::Test {
protected:
  tests::SyntheticRun run_{.steps = {{"40", 10.0}}};
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
} // namespace dyncal::services
