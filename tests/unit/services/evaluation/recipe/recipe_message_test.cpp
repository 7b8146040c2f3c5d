#include "services/evaluation/recipe/recipe_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

TEST(RecipeMessage, ComesOutOfTheMessageAsItWentIn) {
  const auto recipe = parse_recipe(tests::SyntheticRun{}.measurement());
  ASSERT_TRUE(recipe) << recipe.error().message;
  EXPECT_EQ(recipe->reference().text(), "acs/reference");
  EXPECT_EQ(recipe->sources(), (std::vector<std::string>{"acs", "dau"}));
  ASSERT_EQ(recipe->steps.size(), 2U);
  EXPECT_EQ(recipe->steps[1].frequency_text_hz, "80");
  EXPECT_DOUBLE_EQ(recipe->steps[1].duration_s, 0.8);
}

TEST(RecipeMessage, GivesBackTheMessageThatItWasReadFrom) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  wire::AdcCalibrationPoint point;
  point.frequency_hz(40.0);
  point.gain(0.99);
  measurement.adc_calibration().push_back(point);
  measurement.temperature("dau/temperature");
  measurement.u_acs_delay_s(1e-7);
  measurement.level_deviation_rel(0.05);
  measurement.clock_tolerance_rel(5e-5);
  measurement.dut_phase("delay-from-180");
  measurement.excited_axis("z");
  measurement.mains_hz({16.7, 50.0});
  measurement.frequency_search_rel(2e-3);
  wire::ReferenceContribution drift;
  drift.name("drift");
  drift.u_magnitude_rel(1e-3);
  drift.u_phase_rad(2e-3);
  drift.degrees_of_freedom(5.0);
  for (const double hz : {40.0, 80.0}) {
    wire::ReferenceCalibrationPoint calibrated;
    calibrated.frequency_hz(hz);
    calibrated.level_m_s2(10.0);
    calibrated.magnitude(1.01);
    calibrated.phase_rad(-0.01);
    calibrated.contributions().push_back(drift);
    measurement.reference_calibration().push_back(calibrated);
  }
  const auto recipe = parse_recipe(measurement);
  ASSERT_TRUE(recipe) << recipe.error().message;
  EXPECT_TRUE(to_message(*recipe) == measurement);
  EXPECT_EQ(recipe->steps.back().excited_axis, "z");
}

TEST(RecipeMessage, RefusesAMethodOfALaterVersion) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  measurement.method(static_cast<wire::Method>(99));
  const auto recipe = parse_recipe(measurement);
  ASSERT_FALSE(recipe);
  EXPECT_THAT(recipe.error().message, HasSubstr("method has number 99"));
}

TEST(RecipeMessage, TakesTheSyncOfTheOscilloscopeForSeriesAlone) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  measurement.sync_dso("dso/sync");
  EXPECT_EQ(parse_recipe(measurement)->sources(), (std::vector<std::string>{"acs", "dau"}));
  measurement.method(wire::METHOD_SERIES_TIMESTAMPING);
  measurement.dut({"tss/z"});
  EXPECT_EQ(parse_recipe(measurement)->sources(), (std::vector<std::string>{"acs", "dso", "tss"}));
  measurement.sync_dso("");
  EXPECT_THAT(parse_recipe(measurement).error().message, HasSubstr("sync_dso is \"\""));
}

TEST(RecipeMessage, RefusesAStepAtWhichTheReferenceWasNotCalibrated) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  wire::ReferenceCalibrationPoint calibrated;
  calibrated.frequency_hz(40.0);
  calibrated.magnitude(1.0);
  measurement.reference_calibration().push_back(calibrated);
  EXPECT_THAT(parse_recipe(measurement).error().message,
              HasSubstr("step 2 of the recipe: the reference was calibrated from 40 to 40 Hz"));
}

TEST(RecipeMessage, CarriesTheClockOfTheOscilloscopeInSeriesAlone) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  measurement.sync_dau("");
  measurement.sync_dso("dso/sync");
  measurement.dut({"tss/z"});
  measurement.method(wire::METHOD_SERIES_TIMESTAMPING);
  measurement.u_dso_rate_rel(1.4e-5);
  const auto recipe = parse_recipe(measurement);
  ASSERT_TRUE(recipe) << recipe.error().message;
  EXPECT_EQ(recipe->series.u_dso_rate_rel, 1.4e-5);
  EXPECT_EQ(to_message(*recipe).u_dso_rate_rel(), 1.4e-5);
}

TEST(RecipeMessage, RefusesRolesThatAreNoChannels) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  measurement.sync_dau("dau");
  EXPECT_THAT(parse_recipe(measurement).error().message, HasSubstr("sync_dau is \"dau\""));
}

TEST(RecipeMessage, RefusesReferenceAndSyncOfDifferentClocks) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  measurement.sync_acs("other/sync");
  EXPECT_THAT(parse_recipe(measurement).error().message, HasSubstr("must share a clock"));
}

TEST(RecipeMessage, RefusesMoreTrialsThanMemoryHolds) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  measurement.monte_carlo_trials(100'000'000);
  EXPECT_TRUE(parse_recipe(measurement));
  measurement.monte_carlo_trials(100'000'001);
  EXPECT_THAT(
      parse_recipe(measurement).error().message,
      HasSubstr("asks for 100000001 Monte Carlo trials of a value, and at most 100000000 "));
}

TEST(RecipeMessage, RefusesARunWithoutSteps) {
  wire::Measurement measurement = tests::SyntheticRun{}.measurement();
  measurement.steps().clear();
  EXPECT_THAT(parse_recipe(measurement).error().message, HasSubstr("no excitation steps"));
}

} // namespace
} // namespace dyncal::inline evaluation
