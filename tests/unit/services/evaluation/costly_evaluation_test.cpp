// An evaluation that takes long, in a thread of its own: nobody waits for it who need not, and who
// gives it up is not held by it.
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/patience.hpp"
#include "tests/unit/services/evaluation/costly_run.hpp"
#include "tests/unit/services/evaluation/feed.hpp"

namespace dyncal::inline evaluation {
namespace {

const EvaluationLimits beside{.evaluations_at_once = 1, .never_waits = true};

// All has come.
template <class Run>
std::unique_ptr<RunEvaluator> fed(const Run& run, const wire::Measurement& measurement,
                                  const EvaluationLimits& limits) {
  auto evaluator = std::make_unique<RunEvaluator>(*parse_recipe(measurement), limits);
  EXPECT_TRUE(tests::describe(*evaluator, run.acs_description()));
  EXPECT_TRUE(tests::describe(*evaluator, run.dau_description()));
  for (const auto& blocks : {run.acs_blocks(), run.dau_blocks()}) {
    for (const wire::SampleBlock& block : blocks) {
      tests::feed(*evaluator, block);
    }
  }
  return evaluator;
}

// Of a run that ends in the end.
std::vector<StepResult> results_of(RunEvaluator& evaluator) {
  std::vector<StepResult> results;
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (!evaluator.finished() && std::chrono::steady_clock::now() < deadline) {
    for (StepResult& result : evaluator.take_output().results) {
      results.push_back(std::move(result));
    }
    std::this_thread::yield();
  }
  EXPECT_TRUE(evaluator.finished());
  return results;
}

TEST(CostlyEvaluation, IsNotWaitedFor) {
  const tests::CostlyRun run;
  const auto evaluator = fed(run, run.measurement(), beside);
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(evaluator->take_output().results.empty());
  }
  EXPECT_TRUE(evaluator->is_evaluating());
  EXPECT_TRUE(evaluator->has_planned_steps());
  evaluator->end_of_excitation(false);
  evaluator->finish_now();
  EXPECT_TRUE(evaluator->take_output().results.empty());
  EXPECT_TRUE(evaluator->is_evaluating());
  EXPECT_FALSE(evaluator->finished());
}

TEST(CostlyEvaluation, HoldsNobodyWhoDropsIt) {
  const tests::CostlyRun run;
  auto evaluator = fed(run, run.measurement(), beside);
  EXPECT_TRUE(evaluator->take_output().results.empty());
  ASSERT_TRUE(evaluator->is_evaluating());
  const auto begin = std::chrono::steady_clock::now();
  evaluator.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

TEST(CostlyEvaluation, GivesItsValuesWithAFlagWhenItsChecksAreStopped) {
  const tests::CostlyRun run;
  const auto evaluator = fed(run, run.measurement(), beside);
  EXPECT_TRUE(evaluator->take_output().results.empty());
  ASSERT_TRUE(evaluator->is_evaluating());
  evaluator->stop_checks();
  const auto results = results_of(*evaluator);
  ASSERT_EQ(results.size(), tests::CostlyRun::channels);
  for (const StepResult& result : results) {
    EXPECT_TRUE(result.valid) << result.problem;
  }
  EXPECT_FALSE(results.back().monte_carlo);
  ASSERT_EQ(results.back().flags.size(), 1U);
  EXPECT_EQ(results.back().flags[0].kind, ResultFlag::no_monte_carlo_check);
  EXPECT_THAT(results.back().flags[0].sentence, testing::HasSubstr("stopped before its end"));
}

TEST(CostlyEvaluation, GivesTheBitsOfOneInTheCallersThread) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = run.measurement();
  measurement.monte_carlo_trials(20'000);
  const auto besides = results_of(*fed(run, measurement, beside));
  const auto at_once = results_of(*fed(run, measurement, {}));
  ASSERT_EQ(at_once.size(), 2U);
  ASSERT_EQ(besides.size(), 2U);
  for (std::size_t i = 0; i < at_once.size(); ++i) {
    ASSERT_TRUE(at_once[i].monte_carlo);
    EXPECT_TRUE(to_message(Recipe{}, besides[i]) == to_message(Recipe{}, at_once[i]));
  }
}

// What 24 steps tell together, of hum beside every second one.
TEST(CostlyEvaluation, MakesTheEndOfALargeRunBesideItsCaller) {
  tests::SyntheticRun run{.steps = {}, .sensor_hum = 0.05};
  for (int i = 0; i < 24; ++i) {
    run.steps.push_back({i % 2 == 0 ? "50.3" : "80", 10.0});
  }
  const EvaluationLimits in_callers_thread{.ahead = true};
  const EvaluationLimits beside_caller{.never_waits = true, .ahead = true};
  std::vector<EvaluationOutput> ends;
  for (const EvaluationLimits& limits : {in_callers_thread, beside_caller}) {
    const auto evaluator = fed(run, run.measurement(), limits);
    EvaluationOutput end;
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while (!evaluator->finished() && std::chrono::steady_clock::now() < deadline) {
      end = evaluator->take_output();
      EXPECT_TRUE(evaluator->finished() || !evaluator->is_ending() || limits.never_waits);
    }
    ASSERT_TRUE(evaluator->finished());
    EXPECT_TRUE(evaluator->is_ending());
    ends.push_back(std::move(end));
  }
  ASSERT_EQ(ends[0].settled.size(), 24U);
  ASSERT_EQ(ends[1].settled.size(), 24U);
  for (std::size_t i = 0; i < ends[0].settled.size(); ++i) {
    EXPECT_TRUE(to_message(Recipe{}, ends[0].settled[i]) ==
                to_message(Recipe{}, ends[1].settled[i]));
  }
  ASSERT_EQ(ends[0].transfer_functions.size(), 1U);
  ASSERT_EQ(ends[1].transfer_functions.size(), 1U);
  EXPECT_TRUE(to_message(Recipe{}, ends[0].transfer_functions[0]) ==
              to_message(Recipe{}, ends[1].transfer_functions[0]));
}

} // namespace
} // namespace dyncal::inline evaluation
