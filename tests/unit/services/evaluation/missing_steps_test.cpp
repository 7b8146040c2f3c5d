// A conducted run in which one source does not show a step that the other one shows: with steps of
// one frequency the next one must not be taken for it.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;
using State = StepAnnouncement::State;

constexpr double block_s = 50.0 * 997e-6; // of the DAU

class MissingSteps : public testing::TestWithParam<bool> {
protected:
  // Five steps of 2 s at 80 Hz; what the DAU shows of them.
  void play(const std::vector<double>& amplitudes_in_dau) {
    tests::SyntheticRun run;
    run.steps.assign(amplitudes_in_dau.size(), {"80", 10.0});
    evaluator_.emplace(*parse_recipe(run.measurement()), EvaluationLimits{.ahead = GetParam()});
    ASSERT_TRUE(tests::describe(*evaluator_, run.acs_description()));
    ASSERT_TRUE(tests::describe(*evaluator_, run.dau_description()));
    const auto acs = run.acs_blocks();
    for (std::size_t i = 0; i < run.steps.size(); ++i) {
      run.steps[i].amplitude = amplitudes_in_dau[i];
    }
    const auto dau = run.dau_blocks();
    std::size_t sent = 0;
    for (std::uint32_t step = 1; step <= run.steps.size(); ++step) {
      evaluator_->announce({.step = step, .state = State::excited});
      for (; sent < static_cast<std::size_t>((0.3 + 2.0 * step) / block_s); ++sent) {
        tests::feed(*evaluator_, acs.at(sent));
        tests::feed(*evaluator_, dau.at(sent));
        take();
      }
      evaluator_->announce({.step = step, .state = State::done});
      take();
    }
    for (; sent < std::min(acs.size(), dau.size()); ++sent) {
      tests::feed(*evaluator_, acs[sent]);
      tests::feed(*evaluator_, dau[sent]);
      take();
    }
    evaluator_->end_of_excitation(false);
    evaluator_->finish_now();
    take();
  }
  void take() {
    for (bool any = true; any;) {
      EvaluationOutput output = evaluator_->take_output();
      any = !output.results.empty();
      std::move(output.results.begin(), output.results.end(), std::back_inserter(results_));
    }
  }
  // The step of the run, from 1, that the samples of a result are of, by source.
  [[nodiscard]] static int step_of(const SourceSamples& samples) {
    const std::int64_t epoch_ns = samples.source == "dau" ? 1'700'000'000'123'456'789 : 0;
    return static_cast<int>((static_cast<double>(samples.first_stamp_ns - epoch_ns) * 1e-9 - 0.5) /
                            2.0) +
           1;
  }

  std::optional<RunEvaluator> evaluator_;
  std::vector<StepResult> results_;
};

INSTANTIATE_TEST_SUITE_P(AheadOfTheEndOrNot, MissingSteps, testing::Bool());

TEST_P(MissingSteps, AStepThatOneSourceLacksIsNamedAndTheOthersAreJoinedRightly) {
  play({10.0, 10.0, 0.0, 10.0, 10.0});
  ASSERT_EQ(results_.size(), 5U);
  for (const StepResult& result : results_) {
    if (result.step == 3) {
      EXPECT_FALSE(result.valid);
      EXPECT_EQ(result.problem,
                "no steady sine of 80 Hz was found in dau/sync, when acs/sync showed one");
      continue;
    }
    ASSERT_TRUE(result.valid) << result.step << ": " << result.problem;
    ASSERT_EQ(result.samples.size(), 2U);
    EXPECT_EQ(step_of(result.samples[0]), static_cast<int>(result.step));
    EXPECT_EQ(step_of(result.samples[1]), static_cast<int>(result.step));
  }
}

TEST_P(MissingSteps, TwoStepsInARow) {
  play({10.0, 0.0, 0.0, 10.0, 10.0});
  ASSERT_EQ(results_.size(), 5U);
  for (const StepResult& result : results_) {
    EXPECT_EQ(result.valid, result.step != 2 && result.step != 3) << result.step;
    if (result.valid) {
      EXPECT_EQ(step_of(result.samples[0]), step_of(result.samples[1])) << result.step;
    }
  }
}

// No step before tells how far the clocks are apart; what has come of both when steps were
// announced does.
TEST_P(MissingSteps, TheFirstOfAll) {
  play({0.0, 10.0, 10.0, 10.0, 10.0});
  ASSERT_EQ(results_.size(), 5U);
  for (const StepResult& result : results_) {
    EXPECT_EQ(result.valid, result.step != 1) << result.step << ": " << result.problem;
    if (result.valid) {
      EXPECT_EQ(step_of(result.samples[0]), static_cast<int>(result.step));
      EXPECT_EQ(step_of(result.samples[1]), static_cast<int>(result.step));
    } else {
      EXPECT_THAT(result.problem, HasSubstr("was found in dau/sync, when acs/sync showed one"));
    }
  }
}

TEST_P(MissingSteps, NoneIsMissing) {
  play({10.0, 10.0, 10.0, 10.0, 10.0});
  ASSERT_EQ(results_.size(), 5U);
  for (const StepResult& result : results_) {
    EXPECT_TRUE(result.valid) << result.step << ": " << result.problem;
  }
}

} // namespace
} // namespace dyncal::inline evaluation
