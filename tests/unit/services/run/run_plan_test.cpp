#include "services/run/run_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline run {
namespace {

TEST(RunPlan, PlansAllFrequenciesOfARepetitionBeforeTheNext) {
  BenchFile file;
  file.bench = "acc-1";
  file.excitation.frequencies_hz = {"10", "20"};
  file.excitation.levels_m_s2 = {1.0, 2.0};
  file.excitation.repetitions = 2;
  file.method.reference = {"acs", "reference"};
  file.method.sync_acs = {"acs", "sync"};
  file.method.sync_dau = {"dau", "sync"};
  const auto recipe = plan_recipe(file, "r", {});
  ASSERT_TRUE(recipe) << recipe.error().message;
  ASSERT_EQ(recipe->steps.size(), 4U);
  EXPECT_EQ(recipe->steps[2].frequency_text_hz, "10");
  EXPECT_EQ(recipe->steps[2].repetition, 2U);
  EXPECT_EQ(recipe->steps[3].step, 4U);
  EXPECT_DOUBLE_EQ(recipe->steps[3].level_m_s2, 2.0);
}

TEST(RunPlan, RefusesWhatTheMethodDoesNotHave) {
  BenchFile file;
  file.excitation.frequencies_hz = {"10"};
  file.excitation.levels_m_s2 = {1.0};
  file.excitation.settling_from_data = true;
  file.method.kind = EvaluationMethod::absolute_time;
  file.method.reference = {"acs", "reference"};
  file.method.dut = {{"can", "acceleration_z"}};
  const auto recipe = plan_recipe(file, "r", {});
  ASSERT_FALSE(recipe);
  EXPECT_THAT(recipe.error().message,
              testing::HasSubstr("give the longest settling as settling_s"));
}

TEST(RunPlan, RefusesForARunWhatOnlyFilesAreEvaluatedWith) {
  const auto refusal = [](const Recipe& recipe) {
    const auto checked = check_for_run(recipe);
    return checked ? "conducted" : checked.error().message;
  };
  const Recipe plain;
  EXPECT_EQ(refusal(plain), "conducted");
  Recipe response;
  response.channel_responses.push_back({{"dau", "v"}, {}});
  EXPECT_THAT(refusal(response), testing::HasSubstr("the sensitivity of dau/v"));
}

} // namespace
} // namespace dyncal::inline run
