// A large run that nobody wants any more: nothing more is done for it, and what is done is counted.
#include <thread>

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/patience.hpp"
#include "tests/unit/services/evaluation/costly_run.hpp"
#include "tests/unit/services/evaluation/feed.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr std::size_t steps = 24;

tests::SyntheticRun large_run() {
  tests::SyntheticRun run{.steps = {}};
  for (std::size_t i = 0; i < steps; ++i) {
    run.steps.push_back({i % 2 == 0 ? "40" : "80", 10.0});
  }
  return run;
}

// In the caller's thread, and in threads beside it.
class GivenUpRun : public testing::TestWithParam<std::size_t> {
protected:
  template <class Run>
  void feed(const Run& run) {
    evaluator_ = std::make_unique<RunEvaluator>(
        *parse_recipe(run.measurement()),
        EvaluationLimits{.evaluations_at_once = GetParam(), .count = count_});
    ASSERT_TRUE(tests::describe(*evaluator_, run.acs_description()));
    ASSERT_TRUE(tests::describe(*evaluator_, run.dau_description()));
    for (const auto& blocks : {run.acs_blocks(), run.dau_blocks()}) {
      for (const wire::SampleBlock& block : blocks) {
        tests::feed(*evaluator_, block);
      }
    }
  }
  void expect_nothing_more() {
    evaluator_->end_of_excitation(false);
    evaluator_->finish_now();
    const EvaluationOutput output = evaluator_->take_output();
    EXPECT_TRUE(output.results.empty());
    EXPECT_TRUE(output.settled.empty());
    EXPECT_TRUE(output.transfer_functions.empty());
    EXPECT_TRUE(output.clock_reports.empty());
    EXPECT_FALSE(evaluator_->finished());
  }

  SharedWorkCount count_ = std::make_shared<WorkCount>("");
  std::unique_ptr<RunEvaluator> evaluator_;
};

TEST_P(GivenUpRun, EvaluatesNoStep) {
  feed(large_run());
  evaluator_->give_up();
  expect_nothing_more();
  EXPECT_EQ(count_->state().what, "evaluating");
  EXPECT_EQ(count_->state().total, steps);
  EXPECT_EQ(count_->state().done, 0U);
  EXPECT_FALSE(evaluator_->has_planned_steps()); // nor looked for one
}

TEST_P(GivenUpRun, IsEvaluatedWhollyWhereNobodyGivesItUp) {
  feed(large_run());
  const EvaluationOutput output = evaluator_->take_output();
  EXPECT_EQ(output.results.size(), steps);
  EXPECT_EQ(output.transfer_functions.size(), 1U);
  EXPECT_TRUE(evaluator_->finished());
}

// The checks of its only step take tens of seconds.
TEST_P(GivenUpRun, EndsWhatIsUnderWay) {
  feed(tests::CostlyRun());
  std::jthread other([this] {
    while (!evaluator_->is_given_up()) {
      evaluator_->give_up();
    }
  });
  expect_nothing_more();
}

INSTANTIATE_TEST_SUITE_P(Threads, GivenUpRun, testing::Values(0, 2));

// Samples that come before what was announced are searched for every later step.
TEST(GivenUpSearch, LooksForNoStep) {
  const tests::SyntheticRun run = large_run();
  const Recipe recipe = *parse_recipe(run.measurement());
  std::stop_source given_up;
  RunRecords records(recipe, {{{"acs", "sync"}, {"acs"}}}, SourceRecord::default_capacity, true,
                     nullptr, given_up.get_token());
  records.find("acs")->describe(contract::from_message(run.acs_description()));
  for (const wire::SampleBlock& block : run.acs_blocks()) {
    tests::feed(*records.find("acs"), block);
  }
  records.search(1);
  EXPECT_TRUE(records.is_searched(0));
  EXPECT_FALSE(records.is_searched(1));
  given_up.request_stop();
  records.search();
  EXPECT_FALSE(records.is_searched(1));
}

} // namespace
} // namespace dyncal::inline evaluation
