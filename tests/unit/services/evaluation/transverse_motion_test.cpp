#include "services/evaluation/method/transverse_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

StepResult result_of(const std::string& channel, double magnitude) {
  StepResult result;
  result.channel = channel;
  result.frequency_hz = 80.0;
  result.excited_axis = "z";
  result.valid = true;
  result.magnitude = magnitude;
  result.u_magnitude = 1e-4;
  result.phase_rad = 0.0;
  result.u_phase_rad = 1e-4;
  result.unit = "1";
  return result;
}

Recipe recipe_with(std::vector<TransverseMotionPoint> points) {
  Recipe recipe;
  recipe.transverse_motion = {std::move(points), "certificate"};
  return recipe;
}

TEST(TransverseMotion, IsInChannelsAcrossTheExcitedAxis) {
  std::vector<StepResult> results{result_of("dau/acceleration_x", 0.01),
                                  result_of("dau/acceleration_z", 0.98),
                                  result_of("dau/Data_03", 0.5)};
  EXPECT_EQ(add_transverse_motion(recipe_with({{0.0, 0.02}}), results),
            (std::vector<bool>{true, false, false}));
  const double u = 0.02 * 0.98 / std::sqrt(3.0);
  EXPECT_NEAR(results[0].u_magnitude, std::hypot(1e-4, u), 1e-12);
  ASSERT_EQ(results[0].budget.size(), 1U);
  EXPECT_NEAR(results[0].budget[0].u_magnitude_rel, u / 0.01, 1e-12);
  EXPECT_NEAR(results[0].budget[0].u_phase_rad, u / 0.01, 1e-12);
  EXPECT_EQ(results[0].budget[0].repeats, analysis::Repeats::common);
  EXPECT_EQ(results[1].u_magnitude, 1e-4);
  EXPECT_TRUE(results[1].budget.empty());
}

// A phase may be anything, not more.
TEST(TransverseMotion, LeavesAPhaseWithinTheCircle) {
  std::vector<StepResult> results{result_of("dau/acceleration_x", 0.0005),
                                  result_of("dau/acceleration_z", 1.0)};
  ASSERT_TRUE(add_transverse_motion(recipe_with({{0.0, 0.05}}), results)[0]);
  EXPECT_NEAR(results[0].u_phase_rad, std::acos(-1.0) / std::sqrt(3.0), 1e-6);
}

// Nothing can be said: documents refuse the channel.
TEST(TransverseMotion, NeedsAChannelAlongTheAxis) {
  std::vector<StepResult> results{result_of("dau/acceleration_x", 0.01),
                                  result_of("other/acceleration_z", 1.0)};
  EXPECT_EQ(add_transverse_motion(recipe_with({{0.0, 0.02}}), results),
            (std::vector<bool>{false, false}));
  results[1].channel = "dau/acceleration_z";
  results[1].unit = "V";
  EXPECT_FALSE(add_transverse_motion(recipe_with({{0.0, 0.02}}), results)[0]);
  results[1].unit = "1";
  results[1].valid = false;
  EXPECT_FALSE(add_transverse_motion(recipe_with({{0.0, 0.02}}), results)[0]);
  results[1].valid = true;
  EXPECT_FALSE(add_transverse_motion(recipe_with({}), results)[0]);
  EXPECT_TRUE(add_transverse_motion(recipe_with({{0.0, 0.02}}), results)[0]);
}

} // namespace
} // namespace dyncal::inline evaluation
