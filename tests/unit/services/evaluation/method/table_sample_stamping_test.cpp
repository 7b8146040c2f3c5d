// Runs whose reference is a table, against the same run with the samples that the table is made of.
#include <cmath>
#include <complex>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

std::vector<StepResult> results_of_samples(const tests::SyntheticRun& run) {
  RunEvaluator evaluator(*parse_recipe(run.measurement()));
  EXPECT_TRUE(tests::describe(evaluator, run.acs_description()));
  EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
  for (const wire::SampleBlock& block : run.acs_blocks()) {
    tests::feed(evaluator, block);
  }
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    tests::feed(evaluator, block);
  }
  return evaluator.take_output().results;
}

// As the system of the reference would have evaluated it.
ReferenceStep row_of(const StepResult& result) {
  const analysis::SineFit& reference = result.fits.at(0).fit;
  const analysis::SineFit& sync = result.fits.at(1).fit;
  const std::complex<double> ratio =
      std::complex(sync.sine, sync.cosine) / std::complex(reference.sine, reference.cosine);
  return {.step = result.step,
          .repetition = result.repetition,
          .frequency_text_hz = result.frequency_text_hz,
          .amplitude_m_s2 = reference.amplitude(),
          .u_amplitude_m_s2 = 1e-4 * reference.amplitude(),
          .phase_rad = std::arg(ratio),
          .u_phase_rad = 2e-4};
}

wire::Measurement measurement_of_table(const tests::SyntheticRun& run) {
  wire::Measurement measurement = run.measurement();
  measurement.reference_table("acs");
  return measurement;
}

class TableRun {
public:
  explicit TableRun(const tests::SyntheticRun& run)
      : evaluator(*parse_recipe(measurement_of_table(run))) {
    EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
    for (const wire::SampleBlock& block : run.dau_blocks()) {
      tests::feed(evaluator, block);
    }
  }
  RunEvaluator evaluator;
};

TEST(TableSampleStamping, AgreesWithTheSamplesThatTheTableIsMadeOf) {
  const tests::SyntheticRun run;
  const auto expected = results_of_samples(run);
  ASSERT_EQ(expected.size(), 2U);
  TableRun table(run);
  for (const StepResult& result : expected) {
    table.evaluator.add("acs", row_of(result));
    table.evaluator.add("other", row_of(result));
  }
  const EvaluationOutput output = table.evaluator.take_output();
  ASSERT_EQ(output.results.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const StepResult& result = output.results[i];
    ASSERT_TRUE(result.valid) << result.problem;
    EXPECT_NEAR(result.magnitude / expected[i].magnitude, 1.0, 1e-9);
    EXPECT_NEAR(result.phase_rad, expected[i].phase_rad, 1e-9);
    EXPECT_EQ(result.unit, expected[i].unit);
    EXPECT_GT(result.u_magnitude / result.magnitude, 1e-4);
    EXPECT_GT(result.u_phase_rad, 2e-4);
    ASSERT_EQ(result.fits.size(), 4U);
    EXPECT_EQ(result.fits[0].channel, "acs/reference");
    EXPECT_EQ(result.fits[1].channel, "acs/sync");
    EXPECT_EQ(result.samples.size(), 1U);
    for (const Flag& flag : result.flags) {
      EXPECT_NE(flag.kind, ResultFlag::reference_uncertainty_not_stated);
      EXPECT_NE(flag.kind, ResultFlag::acs_delay_not_stated);
    }
  }
  EXPECT_TRUE(table.evaluator.finished());
  EXPECT_EQ(output.transfer_functions.size(), 1U);
}

TEST(TableSampleStamping, WaitsForTheRowOfEachStep) {
  const tests::SyntheticRun run;
  const auto expected = results_of_samples(run);
  TableRun table(run);
  EXPECT_TRUE(table.evaluator.take_output().results.empty());
  table.evaluator.add("acs", row_of(expected.back()));
  EXPECT_TRUE(table.evaluator.take_output().results.empty()); // steps come in their order
  table.evaluator.add("acs", row_of(expected.front()));
  EXPECT_EQ(table.evaluator.take_output().results.size(), 2U);
}

TEST(TableSampleStamping, FlagsAResultWhoseRowIsTakenBack) {
  const tests::SyntheticRun run;
  const auto expected = results_of_samples(run);
  TableRun table(run);
  table.evaluator.add("acs", row_of(expected.front()));
  EXPECT_EQ(table.evaluator.take_output().results.size(), 1U);
  ReferenceStep taken_back = row_of(expected.front());
  taken_back.problem = "the table has changed since";
  table.evaluator.add("acs", taken_back);
  table.evaluator.add("acs", row_of(expected.back()));
  const EvaluationOutput output = table.evaluator.take_output();
  ASSERT_EQ(output.settled.size(), 2U); // all are handed over once more
  for (const StepResult& result : output.settled) {
    EXPECT_EQ(has_flag(result.flags, ResultFlag::step_number_uncertain),
              result.step == expected.front().step);
  }
  EXPECT_THAT(sentences_of(output.settled.front().flags),
              testing::Contains(HasSubstr("the table has changed since")));
}

TEST(TableSampleStamping, GivesAStepWithoutARowNoValue) {
  const tests::SyntheticRun run;
  const auto expected = results_of_samples(run);
  TableRun table(run);
  ReferenceStep missing = row_of(expected.front());
  missing.problem = "the table ends before this step";
  table.evaluator.add("acs", missing);
  const auto first = table.evaluator.take_output().results;
  ASSERT_EQ(first.size(), 1U);
  EXPECT_FALSE(first.front().valid);
  EXPECT_EQ(first.front().problem, "the table ends before this step");
  EXPECT_TRUE(std::isnan(first.front().magnitude));
  table.evaluator.finish_now();
  const auto last = table.evaluator.take_output().results;
  ASSERT_EQ(last.size(), 1U);
  EXPECT_FALSE(last.front().valid);
  EXPECT_EQ(last.front().problem, "source 'acs' gave no row of its table for this step");
}

TEST(TableSampleStamping, GivesTheSameBitsFromMessages) {
  const tests::SyntheticRun run;
  const auto expected = results_of_samples(run);
  std::vector<std::vector<StepResult>> outputs;
  for (int time = 0; time < 2; ++time) {
    TableRun table(run);
    for (const StepResult& result : expected) {
      table.evaluator.add("acs", contract::from_message(contract::to_message(row_of(result))));
    }
    outputs.push_back(table.evaluator.take_output().results);
  }
  ASSERT_EQ(outputs[0].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(outputs[0][i].magnitude, outputs[1][i].magnitude);
    EXPECT_EQ(outputs[0][i].u_phase_rad, outputs[1][i].u_phase_rad);
    EXPECT_EQ(outputs[0][i].data_sha256, outputs[1][i].data_sha256);
  }
}

TEST(TableSampleStamping, IsRefusedWhereItCannotBe) {
  const tests::SyntheticRun run;
  const auto problem_of = [&](const std::function<void(wire::Measurement&)>& change) {
    wire::Measurement measurement = measurement_of_table(run);
    change(measurement);
    const auto recipe = parse_recipe(measurement);
    return recipe ? "none" : recipe.error().message;
  };
  EXPECT_THAT(problem_of([](auto& one) { one.reference_table("laser"); }),
              HasSubstr("they must be of that source"));
  EXPECT_THAT(problem_of([](auto& one) { one.settling_from_data(true); }),
              HasSubstr("has no samples to see the settling of"));
  EXPECT_THAT(problem_of([](auto& one) { one.dut() = {"can/z"}; }),
              HasSubstr("needs method kind = \"sample-timestamping\""));
}

} // namespace
} // namespace dyncal::inline evaluation
