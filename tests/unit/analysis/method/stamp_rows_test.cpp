#include "analysis/method/stamp_rows.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double w = 500.0;

TEST(StampRows, AreBoundsOfMagnitudeAndPhase) {
  Budget budget;
  add_beat_rows(budget, "the sensor's", w, {.in_step_rad = 3e-3, .mean_s = 6e-6}, {});
  ASSERT_EQ(budget.rows().size(), 2U);
  const Contribution& in_step = budget.rows()[0];
  EXPECT_EQ(in_step.name(), "tick of the sensor's stamps, in step with the signal");
  EXPECT_DOUBLE_EQ(in_step.u_magnitude_rel, 3e-3 / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(in_step.u_phase_rad, 3e-3 / std::sqrt(3.0));
  EXPECT_EQ(in_step.repeats, Repeats::anew);
  const Contribution& mean = budget.rows()[1];
  EXPECT_EQ(mean.name(), "tick of the sensor's stamps, on average");
  EXPECT_EQ(mean.u_magnitude_rel, 0.0);
  EXPECT_DOUBLE_EQ(mean.u_phase_rad, w * 6e-6 / std::sqrt(3.0));
  EXPECT_EQ(mean.repeats, Repeats::common_delay); // a slow saw-tooth: alike in the whole run
}

TEST(StampRows, AreNoneWhereNothingIsInStep) {
  Budget budget;
  add_beat_rows(budget, "the DAU", w, {}, {});
  EXPECT_TRUE(budget.rows().empty());
}

TEST(StampRows, OfARatioKnowOnlyWhatThePhasesDifferBy) {
  const BeatReach alike = reach_on_ratio(0.3, 0.3 + std::numbers::pi);
  EXPECT_NEAR(alike.in_step_phase, 0.0, 1e-12);
  const BeatReach across = reach_on_ratio(0.3, 0.3 - 0.5 * std::numbers::pi);
  EXPECT_NEAR(across.in_step_phase, 2.0, 1e-12);
  EXPECT_NEAR(across.in_step_magnitude, 2.0, 1e-12);
  EXPECT_EQ(across.on_average, 0.0);
}

} // namespace
} // namespace dyncal::analysis
