#include "services/evaluation/method/channel_responses.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

StepResult result_of(const std::string& channel, double frequency_hz) {
  StepResult result;
  result.channel = channel;
  result.frequency_hz = frequency_hz;
  result.level_m_s2 = 10.0;
  result.valid = true;
  result.magnitude = 0.5;
  result.u_magnitude = 1e-4;
  result.phase_rad = 3.0;
  result.u_phase_rad = 2e-4;
  return result;
}

Recipe recipe_of_amplifier() {
  const auto point = [](double frequency_hz, double magnitude, double phase_rad) {
    return analysis::ReferenceCalibrationPoint{
        .frequency_hz = frequency_hz,
        .magnitude = magnitude,
        .phase_rad = phase_rad,
        .contributions = {{.name = "drift", .u_magnitude_rel = 3e-4, .u_phase_rad = 5e-4}}};
  };
  Recipe recipe;
  recipe.channel_responses = {
      {{"acs", "charge"}, {point(10.0, 1.02, -0.3), point(20.0, 0.98, -0.6)}}};
  return recipe;
}

TEST(ChannelResponses, DivideTheResultsOfTheirChannel) {
  std::vector<StepResult> results{result_of("acs/charge", 20.0), result_of("acs/other", 20.0)};
  EXPECT_EQ(take_channel_responses(recipe_of_amplifier(), results),
            (std::vector<bool>{true, false}));
  const StepResult& changed = results[0];
  EXPECT_NEAR(changed.magnitude, 0.5 / 0.98, 1e-15);
  EXPECT_NEAR(changed.u_magnitude, std::hypot(1e-4, 3e-4 * 0.5) / 0.98, 1e-15);
  EXPECT_NEAR(changed.phase_rad, 3.6 - 2.0 * std::acos(-1.0), 1e-12); // within half a turn
  EXPECT_NEAR(changed.u_phase_rad, std::hypot(2e-4, 5e-4), 1e-15);
  ASSERT_EQ(changed.budget.size(), 2U); // with that of interpolation, which is 0 at a point
  EXPECT_EQ(changed.budget[0].name(), "response of the channel, drift");
  EXPECT_EQ(changed.budget[0].u_magnitude_rel, 3e-4);
  EXPECT_EQ(changed.budget[0].repeats, analysis::Repeats::common);
  EXPECT_EQ(changed.budget[1].u_phase_rad, 0.0);
  EXPECT_EQ(results[1].magnitude, 0.5);
  EXPECT_TRUE(results[1].budget.empty());
}

TEST(ChannelResponses, AreNotExtrapolated) {
  std::vector<StepResult> results{result_of("acs/charge", 21.0)};
  EXPECT_EQ(take_channel_responses(recipe_of_amplifier(), results), std::vector<bool>{false});
  EXPECT_FALSE(results[0].valid);
  EXPECT_NE(results[0].problem.find("not at 21 Hz"), std::string::npos);
}

TEST(ChannelResponses, LeaveResultsWithoutAValueAlone) {
  std::vector<StepResult> results{result_of("acs/charge", 20.0)};
  results[0].valid = false;
  EXPECT_EQ(take_channel_responses(recipe_of_amplifier(), results), std::vector<bool>{false});
  EXPECT_TRUE(results[0].budget.empty());
}

std::vector<StepResult> results_of(const tests::SyntheticRun& run, const Recipe& recipe) {
  RunEvaluator evaluator(recipe);
  EXPECT_TRUE(tests::describe(evaluator, run.acs_description()));
  EXPECT_TRUE(tests::describe(evaluator, run.dau_description()));
  for (const auto& blocks : {run.acs_blocks(), run.dau_blocks()}) {
    for (const wire::SampleBlock& block : blocks) {
      tests::feed(evaluator, block);
    }
  }
  evaluator.finish_now();
  return evaluator.take_output().results;
}

TEST(ChannelResponses, AreTakenFromTheResultsOfARun) {
  const tests::SyntheticRun run;
  Recipe recipe = *parse_recipe(run.measurement());
  const std::vector<StepResult> read = results_of(run, recipe);
  const auto point = [](double frequency_hz, double magnitude, double phase_rad) {
    return analysis::ReferenceCalibrationPoint{
        .frequency_hz = frequency_hz,
        .magnitude = magnitude,
        .phase_rad = phase_rad,
        .contributions = {{.u_magnitude_rel = 2e-3, .u_phase_rad = 1e-3}}};
  };
  recipe.channel_responses = {{*parse_channel_name(read.at(0).channel),
                               {point(40.0, 1.05, -0.1), point(80.0, 0.97, -0.4)}}};
  ASSERT_TRUE(check_recipe(recipe));
  const std::vector<StepResult> corrected = results_of(run, recipe);
  ASSERT_EQ(read.size(), 2U);
  ASSERT_EQ(corrected.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(read[i].valid) << read[i].problem;
    EXPECT_NEAR(corrected[i].magnitude, read[i].magnitude / (i == 0 ? 1.05 : 0.97), 1e-12);
    const double turned = corrected[i].phase_rad - read[i].phase_rad - (i == 0 ? 0.1 : 0.4);
    EXPECT_NEAR(std::remainder(turned, 2.0 * std::acos(-1.0)), 0.0, 1e-12);
    EXPECT_GE(corrected[i].u_magnitude, 2e-3 * corrected[i].magnitude);
    EXPECT_EQ(corrected[i].budget.size(), read[i].budget.size() + 2);
  }
  recipe.channel_responses[0].points.pop_back();
  EXPECT_FALSE(check_recipe(recipe)); // 80 Hz is not in the table
}

} // namespace
} // namespace dyncal::inline evaluation
