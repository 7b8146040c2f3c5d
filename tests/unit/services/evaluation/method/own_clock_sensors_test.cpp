// Sensors with stamps of their own: absolute time, and sync recorded beside them.
#include "services/evaluation/method/own_clock_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/monte_carlo_agreement.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

constexpr double u_stamp_s = 5e-6;

// The acceleration of the synthetic DAU as a sensor on CAN would send it: every second sample,
// under its own name and numbers.
std::vector<wire::SampleBlock> on_can(const tests::SyntheticRun& run, const std::string& source) {
  std::vector<wire::SampleBlock> blocks;
  std::uint64_t number = 0;
  for (const wire::SampleBlock& of_dau : run.dau_blocks()) {
    wire::SampleBlock block;
    block.bench("synthetic");
    block.source(source);
    block.session(9);
    block.block(blocks.size());
    block.first_sample(number);
    block.channel_count(1);
    for (std::size_t i = 1; i < of_dau.sample_count(); i += 2) {
      block.stamps_ns().push_back(of_dau.stamps_ns()[i]);
      block.stamp_uncertainty_ns().push_back(static_cast<std::uint32_t>(u_stamp_s * 1e9));
      block.values().push_back(of_dau.values()[i]);
    }
    block.sample_count(static_cast<std::uint32_t>(block.stamps_ns().size()));
    block.end_of_stream(of_dau.end_of_stream());
    number += block.sample_count();
    blocks.push_back(block);
  }
  return blocks;
}

wire::SourceDescription can_description(const std::string& source) {
  wire::SourceDescription description = tests::SyntheticRun{}.dau_description();
  description.source(source);
  description.session(9);
  description.kind(wire::SOURCE_CAN);
  description.time_base(wire::TIME_BASE_UTC);
  description.stamp_uncertainty_s(u_stamp_s);
  description.channels().resize(1);
  return description;
}

// The synthetic ACS on the time scale of the synthetic DAU.
std::vector<wire::SampleBlock> acs_in_utc(const tests::SyntheticRun& run) {
  std::vector<wire::SampleBlock> blocks = run.acs_blocks();
  for (wire::SampleBlock& block : blocks) {
    block.origin_ns(run.dau_blocks().front().stamps_ns().front());
  }
  return blocks;
}

wire::SourceDescription in_utc(wire::SourceDescription description) {
  description.time_base(wire::TIME_BASE_UTC);
  return description;
}

wire::Measurement absolute(const tests::SyntheticRun& run) {
  wire::Measurement measurement = run.measurement();
  measurement.method(wire::METHOD_ABSOLUTE_TIME);
  measurement.sync_acs("");
  measurement.sync_dau("");
  measurement.u_acs_delay_s(0.0); // of the clock of the ACS nothing is known
  measurement.dut() = {"can/acceleration_z", "other/acceleration_z"};
  return measurement;
}

std::vector<StepResult> evaluate(RunEvaluator& evaluator,
                                 const std::vector<std::vector<wire::SampleBlock>>& sources) {
  std::vector<StepResult> results;
  std::size_t longest = 0;
  for (const auto& blocks : sources) {
    longest = std::max(longest, blocks.size());
  }
  for (std::size_t i = 0; i < longest; ++i) {
    for (const auto& blocks : sources) {
      if (i < blocks.size()) {
        tests::feed(evaluator, blocks[i]);
      }
    }
    const EvaluationOutput output = evaluator.take_output();
    results.insert(results.end(), output.results.begin(), output.results.end());
    for (const StepResult& settled : output.settled) {
      *std::find_if(results.begin(), results.end(), [&](const StepResult& one) {
        return one.channel == settled.channel && one.step == settled.step;
      }) = settled;
    }
  }
  EXPECT_TRUE(evaluator.finished());
  return results;
}

double u_of(const StepResult& result, const std::string& row) {
  for (const analysis::Contribution& line : result.budget) {
    if (line.name() == row) {
      return line.u_phase_rad;
    }
  }
  return -1.0;
}

void expect_truth(const StepResult& result, const tests::SyntheticRun& run) {
  ASSERT_TRUE(result.valid) << result.problem;
  EXPECT_NEAR(result.magnitude, run.magnitude, 4.0 * result.u_magnitude);
  EXPECT_NEAR(result.phase_rad, -2.0 * std::numbers::pi * result.frequency_hz * run.delay_s,
              4.0 * result.u_phase_rad);
  EXPECT_LT(result.u_phase_rad, 5e-3);
  EXPECT_NEAR(u_of(result, "offset between the clocks"),
              2.0 * std::numbers::pi * result.frequency_hz * u_stamp_s, 1e-9);
}

TEST(OwnClockSensors, LinksSensorsByAbsoluteTimeWithoutAnySync) {
  const tests::SyntheticRun run;
  RunEvaluator evaluator(*parse_recipe(absolute(run)));
  EXPECT_EQ(evaluator.recipe().sources(), (std::vector<std::string>{"acs", "can", "other"}));
  ASSERT_TRUE(tests::describe(evaluator, in_utc(run.acs_description())));
  ASSERT_TRUE(tests::describe(evaluator, can_description("can")));
  ASSERT_TRUE(tests::describe(evaluator, can_description("other")));
  const auto results =
      evaluate(evaluator, {acs_in_utc(run), on_can(run, "can"), on_can(run, "other")});
  ASSERT_EQ(results.size(), 4U); // two steps, two sensors
  for (const StepResult& result : results) {
    expect_truth(result, run);
    EXPECT_EQ(result.fits.size(), 2U);
    EXPECT_EQ(result.samples.size(), 2U);
    EXPECT_EQ(sentences_of(result.flags),
              std::vector<std::string>{"acs: nothing is known of the uncertainty of its clock"});
  }
  EXPECT_EQ(results[0].channel, "can/acceleration_z");
  EXPECT_EQ(results[1].channel, "other/acceleration_z");
  EXPECT_EQ(results[0].phase_rad, results[1].phase_rad);
}

TEST(OwnClockSensors, LinksSensorsByASyncThatIsRecordedBesideThem) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = run.measurement();
  measurement.dut() = {"can/acceleration_z"};
  RunEvaluator evaluator(*parse_recipe(measurement));
  ASSERT_TRUE(tests::describe(evaluator, run.acs_description())); // a clock of its own
  ASSERT_TRUE(tests::describe(evaluator, in_utc(run.dau_description())));
  ASSERT_TRUE(tests::describe(evaluator, can_description("can")));
  const auto results =
      evaluate(evaluator, {run.acs_blocks(), run.dau_blocks(), on_can(run, "can")});
  ASSERT_EQ(results.size(), 2U);
  for (const StepResult& result : results) {
    expect_truth(result, run);
    EXPECT_EQ(result.fits.size(), 4U);
    ASSERT_EQ(result.samples.size(), 3U);
    EXPECT_EQ(result.samples[2].source, "can");
  }
}

TEST(OwnClockSensors, ChecksTheBudgetByDrawingWhenTheRecipeAsksForIt) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = absolute(run);
  measurement.dut() = {"can/acceleration_z"};
  measurement.monte_carlo_trials(50'000);
  RunEvaluator by_time(*parse_recipe(measurement));
  ASSERT_TRUE(tests::describe(by_time, in_utc(run.acs_description())));
  ASSERT_TRUE(tests::describe(by_time, can_description("can")));
  tests::expect_drawing_agrees(evaluate(by_time, {acs_in_utc(run), on_can(run, "can")}), 2);

  measurement = run.measurement();
  measurement.dut() = {"can/acceleration_z"};
  measurement.monte_carlo_trials(50'000);
  RunEvaluator by_sync(*parse_recipe(measurement));
  ASSERT_TRUE(tests::describe(by_sync, run.acs_description()));
  ASSERT_TRUE(tests::describe(by_sync, in_utc(run.dau_description())));
  ASSERT_TRUE(tests::describe(by_sync, can_description("can")));
  tests::expect_drawing_agrees(
      evaluate(by_sync, {run.acs_blocks(), run.dau_blocks(), on_can(run, "can")}), 2);
}

TEST(OwnClockSensors, RefusesSettlingFromTheDataWithASentence) {
  wire::Measurement measurement = absolute({});
  measurement.settling_from_data(true);
  EXPECT_THAT(parse_recipe(measurement).error().message,
              HasSubstr("give the longest settling as settling_s"));
}

TEST(OwnClockSensors, RefusesClocksThatCannotBeCompared) {
  const tests::SyntheticRun run;
  RunEvaluator by_time(*parse_recipe(absolute(run)));
  EXPECT_THAT(tests::describe(by_time, run.acs_description()).error().message,
              HasSubstr("'acs' has a clock of its own, but absolute time"));
  wire::Measurement measurement = run.measurement();
  measurement.dut() = {"can/acceleration_z"};
  RunEvaluator by_sync(*parse_recipe(measurement));
  ASSERT_TRUE(tests::describe(by_sync, run.dau_description()));
  EXPECT_THAT(tests::describe(by_sync, can_description("can")).error().message,
              HasSubstr("must be stamped on one time scale"));
}

TEST(OwnClockSensors, GivesNoNumberForAStepWhoseSamplesAreNotThere) {
  const tests::SyntheticRun run;
  wire::Measurement measurement = absolute(run);
  measurement.dut() = {"can/acceleration_z"};
  RunEvaluator evaluator(*parse_recipe(measurement));
  ASSERT_TRUE(tests::describe(evaluator, in_utc(run.acs_description())));
  ASSERT_TRUE(tests::describe(evaluator, can_description("can")));
  auto blocks = on_can(run, "can");
  blocks.resize(blocks.size() / 2);
  blocks.back().end_of_stream(true);
  const auto results = evaluate(evaluator, {acs_in_utc(run), blocks});
  ASSERT_EQ(results.size(), 2U);
  expect_truth(results[0], run);
  EXPECT_FALSE(results[1].valid);
  EXPECT_THAT(results[1].problem,
              HasSubstr("can: no sample with a trusted stamp lies in the step"));
}

TEST(OwnClockSensors, NeedsToKnowItsSensors) {
  wire::Measurement measurement = absolute({});
  measurement.dut().clear();
  EXPECT_THAT(parse_recipe(measurement).error().message,
              HasSubstr("names no channel under calibration"));
  wire::Measurement mixed = tests::SyntheticRun{}.measurement();
  mixed.dut() = {"can/acceleration_z", "dau/acceleration_z"};
  EXPECT_THAT(parse_recipe(mixed).error().message,
              HasSubstr("either all of the source of sync_dau, whose stamps they share, or none"));
}

} // namespace
} // namespace dyncal::inline evaluation
