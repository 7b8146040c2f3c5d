// Every loss of samples reaches the result of the step it belongs to, and no other.
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::Contains;
using testing::HasSubstr;

// About 1.1 s into the run, in the evaluated part of the first of its two steps.
constexpr std::size_t block_in_first_step = 22;

using Blocks = std::vector<wire::SampleBlock>;

EvaluationOutput evaluate(const std::function<void(Blocks&)>& spoil,
                          const EvaluationLimits& limits = {}) {
  const tests::SyntheticRun run;
  RunEvaluator evaluator(*parse_recipe(run.measurement()), limits);
  EXPECT_TRUE(tests::describe(evaluator, run.acs_description()));
  EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
  Blocks dau = run.dau_blocks();
  spoil(dau);
  for (const wire::SampleBlock& block : run.acs_blocks()) {
    tests::feed(evaluator, block);
  }
  for (const wire::SampleBlock& block : dau) {
    tests::feed(evaluator, block);
  }
  EvaluationOutput output = evaluator.take_output();
  EXPECT_TRUE(evaluator.finished());
  EXPECT_EQ(output.results.size(), 2U);
  EXPECT_TRUE(output.results.at(0).valid) << output.results.at(0).problem;
  return output;
}

const SourceSamples& of_dau(const StepResult& result) {
  return result.samples.at(1);
}

void expect_untouched(const StepResult& result) {
  EXPECT_EQ(result.lost, 0U);
  EXPECT_EQ(of_dau(result).not_trusted + of_dau(result).not_measured, 0U);
  EXPECT_THAT(result.flags, testing::IsEmpty());
}

TEST(Loss, AnUndisturbedRunHasNone) {
  const EvaluationOutput output = evaluate([](Blocks&) {});
  expect_untouched(output.results[0]);
  expect_untouched(output.results[1]);
  EXPECT_EQ(output.clock_reports.at(0).clock.lost, 0U);
}

TEST(Loss, OfABlockThatDidNotCome) {
  const EvaluationOutput output =
      evaluate([](Blocks& blocks) { blocks.erase(blocks.begin() + block_in_first_step); });
  EXPECT_EQ(of_dau(output.results[0]).lost, 50U);
  EXPECT_EQ(output.results[0].lost, 50U);
  EXPECT_THAT(sentences_of(output.results[0].flags), Contains("dau: samples lost"));
  expect_untouched(output.results[1]);
  EXPECT_EQ(output.transfer_functions.at(0).lost, 50U);
  EXPECT_EQ(output.clock_reports.at(0).clock.lost, 50U);
}

// A source that numbers what it sends, not what it measured.
TEST(Loss, OfSamplesThatOnlyTheStampsShow) {
  const EvaluationOutput output = evaluate([](Blocks& blocks) {
    const auto gone = blocks.erase(blocks.begin() + block_in_first_step);
    for (auto block = gone; block != blocks.end(); ++block) {
      block->block(block->block() - 1);
      block->first_sample(block->first_sample() - 50);
    }
  });
  EXPECT_EQ(of_dau(output.results[0]).lost, 50U);
  EXPECT_EQ(output.results[0].lost, 50U);
  EXPECT_THAT(sentences_of(output.results[0].flags), Contains("dau: samples lost"));
  expect_untouched(output.results[1]);
  EXPECT_EQ(output.clock_reports.at(0).clock.lost, 50U);
  EXPECT_NEAR(output.clock_reports.at(0).clock.mean_interval_s, 997e-6, 1e-9);
}

TEST(Loss, OfABlockThatCannotBeUsed) {
  const EvaluationOutput output =
      evaluate([](Blocks& blocks) { blocks[block_in_first_step].values().pop_back(); });
  EXPECT_EQ(of_dau(output.results[0]).unusable, 50U);
  EXPECT_EQ(of_dau(output.results[0]).lost, 0U);
  EXPECT_EQ(output.results[0].lost, 50U);
  EXPECT_THAT(sentences_of(output.results[0].flags), Contains("dau: samples lost"));
  expect_untouched(output.results[1]);
  EXPECT_EQ(output.clock_reports.at(0).clock.lost, 50U);
}

TEST(Loss, OfABlockThatCannotBeUsedBesideOneThatDidNotCome) {
  const EvaluationOutput output = evaluate([](Blocks& blocks) {
    blocks[block_in_first_step].values().pop_back();
    blocks.erase(blocks.begin() + block_in_first_step + 1);
  });
  EXPECT_EQ(of_dau(output.results[0]).unusable, 50U);
  EXPECT_EQ(of_dau(output.results[0]).lost, 50U);
  EXPECT_EQ(output.results[0].lost, 100U);
}

TEST(Loss, OfSamplesThatAFullRecordDropped) {
  const tests::SyntheticRun run;
  RunEvaluator evaluator(*parse_recipe(run.measurement()), {.samples_of_a_source = 32'000});
  ASSERT_TRUE(tests::describe(evaluator, run.acs_description()));
  ASSERT_TRUE(tests::describe(evaluator, run.dau_description()));
  // The ACS is 4.5 s ahead of the DAU, and its record holds 3.2 s: what was found of the first
  // step, from 0.7 s to 1.5 s, is dropped in part before the DAU has sent it.
  for (const wire::SampleBlock& block : run.acs_blocks()) {
    tests::feed(evaluator, block);
    EXPECT_TRUE(evaluator.take_output().results.empty());
  }
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    tests::feed(evaluator, block);
  }
  const EvaluationOutput output = evaluator.take_output();
  ASSERT_EQ(output.results.size(), 2U);
  ASSERT_TRUE(output.results[0].valid) << output.results[0].problem;
  const SourceSamples& acs = output.results[0].samples.at(0);
  EXPECT_NEAR(static_cast<double>(acs.overflowed), 6000.0, 600.0); // whole blocks of 500
  EXPECT_EQ(acs.lost, 0U);
  EXPECT_EQ(output.results[0].lost, acs.overflowed);
  EXPECT_THAT(sentences_of(output.results[0].flags), Contains("acs: samples lost"));
  expect_untouched(output.results[1]);
}

TEST(Loss, OfSamplesThatWereNotMeasured) {
  const EvaluationOutput output = evaluate([](Blocks& blocks) {
    blocks[block_in_first_step].values()[3] = std::nan("");
    blocks[block_in_first_step].values()[9] = std::nan("");
  });
  EXPECT_EQ(of_dau(output.results[0]).not_measured, 2U);
  EXPECT_EQ(of_dau(output.results[0]).not_trusted, 0U);
  EXPECT_THAT(sentences_of(output.results[0].flags),
              Contains(HasSubstr("dau: samples left out, they were not measured")));
  EXPECT_EQ(output.results[0].lost, 0U);
  expect_untouched(output.results[1]);
}

TEST(Loss, OfSamplesWhoseStampIsNotTrusted) {
  const EvaluationOutput output = evaluate([](Blocks& blocks) {
    wire::SampleBlock& block = blocks[block_in_first_step];
    block.stamp_flags().assign(block.sample_count(), 0);
    block.stamp_flags()[7] = 1;
    block.stamps_ns()[20] = block.stamps_ns()[19];
  });
  EXPECT_EQ(of_dau(output.results[0]).not_trusted, 2U);
  EXPECT_EQ(of_dau(output.results[0]).not_measured, 0U);
  EXPECT_THAT(sentences_of(output.results[0].flags),
              Contains(HasSubstr("dau: samples left out, their stamps are not trusted")));
  expect_untouched(output.results[1]);
}

TEST(Loss, IsTheSameWhenStepsAreEvaluatedInThreadsOfTheirOwn) {
  const auto spoil = [](Blocks& blocks) { blocks[block_in_first_step].values().pop_back(); };
  const StepResult here = evaluate(spoil).results[0];
  const StepResult elsewhere = evaluate(spoil, {.evaluations_at_once = 2}).results[0];
  EXPECT_EQ(of_dau(elsewhere).unusable, 50U);
  EXPECT_EQ(elsewhere.flags, here.flags);
  EXPECT_EQ(elsewhere.lost, here.lost);
}

} // namespace
} // namespace dyncal::inline evaluation
