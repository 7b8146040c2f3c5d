// Live, a step is evaluated while it is still excited: its result does not wait for its samples to
// be looked at when the last of them has come.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

struct Evaluated {
  std::vector<StepResult> results;
  std::size_t steps_ready = 0;
  std::size_t transfer_functions = 0;
  bool at_once = true; // every result came alone, with the output that found the step's end
};

Evaluated evaluate(const tests::SyntheticRun& run, const wire::Measurement& measurement,
                   bool ahead) {
  RunEvaluator evaluator(*parse_recipe(measurement), {.ahead = ahead});
  EXPECT_TRUE(tests::describe(evaluator, run.acs_description()));
  EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
  const auto acs = run.acs_blocks();
  const auto dau = run.dau_blocks();
  Evaluated all;
  for (std::size_t i = 0; i < std::max(acs.size(), dau.size()); ++i) {
    if (i < acs.size()) {
      tests::feed(evaluator, acs[i]);
    }
    if (i < dau.size()) {
      tests::feed(evaluator, dau[i]);
    }
    EvaluationOutput output;
    do {
      const std::size_t ready = evaluator.steps_ready();
      output = evaluator.take_output();
      all.at_once &= output.results.empty() == (evaluator.steps_ready() == ready);
      all.at_once &= output.results.empty() || output.transfer_functions.empty();
      all.results.insert(all.results.end(), output.results.begin(), output.results.end());
      all.transfer_functions += output.transfer_functions.size();
    } while (!output.results.empty());
  }
  EXPECT_TRUE(evaluator.finished());
  all.steps_ready = evaluator.steps_ready();
  return all;
}

void expect_same(const Evaluated& one, const Evaluated& other) {
  ASSERT_EQ(one.results.size(), 2U);
  ASSERT_EQ(other.results.size(), 2U);
  for (std::size_t i = 0; i < one.results.size(); ++i) {
    EXPECT_TRUE(to_message(Recipe{}, one.results[i]) == to_message(Recipe{}, other.results[i]))
        << "result " << i;
  }
}

TEST(EvaluationAhead, ResultsAreThereWhenTheEndOfAStepIsFound) {
  tests::SyntheticRun run;
  for (const std::size_t block_samples : {7UL, 50UL}) {
    run.block_samples = block_samples;
    const Evaluated ahead = evaluate(run, run.measurement(), true);
    EXPECT_EQ(ahead.steps_ready, 2U);
    EXPECT_TRUE(ahead.at_once);
    EXPECT_EQ(ahead.transfer_functions, 1U);
    EXPECT_TRUE(ahead.results.front().valid);
    const Evaluated afterwards = evaluate(run, run.measurement(), false);
    EXPECT_EQ(afterwards.steps_ready, 0U);
    expect_same(ahead, afterwards);
  }
}

TEST(EvaluationAhead, HoldsWhereSettlingIsFoundFromTheData) {
  tests::SyntheticRun run;
  run.settling_time_constant_s = 0.02;
  wire::Measurement measurement = run.measurement();
  measurement.settling_from_data(true);
  const Evaluated ahead = evaluate(run, measurement, true);
  EXPECT_EQ(ahead.steps_ready, 2U);
  expect_same(ahead, evaluate(run, measurement, false));
}

TEST(EvaluationAhead, AnExcitationThatEndsTooSoonIsEvaluatedAtItsEnd) {
  tests::SyntheticRun run;
  run.on_s = 0.95; // of one second that is planned
  const Evaluated ahead = evaluate(run, run.measurement(), true);
  EXPECT_EQ(ahead.steps_ready, 0U);
  EXPECT_TRUE(ahead.results.front().valid);
  expect_same(ahead, evaluate(run, run.measurement(), false));
}

TEST(EvaluationAhead, BlocksLongerThanAStepGiveTheSame) {
  tests::SyntheticRun run;
  run.block_samples = 1600;
  const Evaluated ahead = evaluate(run, run.measurement(), true);
  expect_same(ahead, evaluate(run, run.measurement(), false));
}

TEST(EvaluationAhead, LostSamplesAreCountedAsAfterwards) {
  tests::SyntheticRun run;
  run.lost_block = 22;
  const Evaluated ahead = evaluate(run, run.measurement(), true);
  EXPECT_GT(ahead.results.front().lost, 0U);
  EXPECT_EQ(ahead.steps_ready, 2U);
  expect_same(ahead, evaluate(run, run.measurement(), false));
}

} // namespace
} // namespace dyncal::inline evaluation
