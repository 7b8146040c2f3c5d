#include "services/evaluation/transfer_summary.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

// Three sweeps of four frequencies, each as late as given beside 2 ms; noise 1e-4 rad.
analysis::GroupDelay group_delay_of(const std::array<double, 3>& late_s) {
  const Recipe recipe;
  TransferSummary summary(recipe);
  std::uint32_t step = 0;
  for (std::uint32_t sweep = 1; sweep <= late_s.size(); ++sweep) {
    for (const double hz : {20.0, 40.0, 63.0, 125.0}) {
      StepResult result;
      result.channel = "dau/acceleration_z";
      result.step = ++step;
      result.repetition = sweep;
      result.valid = true;
      result.frequency_hz = hz;
      result.frequency_text_hz = fmt::format("{}", hz);
      result.magnitude = 1.0;
      result.phase_rad = std::remainder(-2.0 * std::numbers::pi * hz * (2e-3 + late_s[sweep - 1]),
                                        2.0 * std::numbers::pi);
      result.budget = {{.kind = analysis::ContributionKind::fit_noise,
                        .u_magnitude_rel = 1e-4,
                        .u_phase_rad = 1e-4}};
      summary.add(result);
    }
  }
  const auto functions = summary.transfer_functions();
  EXPECT_EQ(functions.size(), 1U);
  EXPECT_TRUE(functions.front().group_delay) << functions.front().group_delay_problem;
  return functions.front().group_delay.value_or(analysis::GroupDelay{});
}

TEST(TransferSummary, TakesADelayThatASweepSharesIntoTheGroupDelay) {
  const analysis::GroupDelay same = group_delay_of({0.0, 0.0, 0.0});
  const analysis::GroupDelay late = group_delay_of({-30e-6, 10e-6, 20e-6});
  EXPECT_NEAR(late.delay_s, 2e-3, 1e-8);
  EXPECT_LT(same.u_delay_s(), 0.5e-6);
  // Student's factor of two degrees of freedom over 2: 26.5 us / sqrt(3) x 2.26.
  EXPECT_GT(late.u_delay_s(), 30e-6);
  EXPECT_LT(late.u_delay_s(), 50e-6);
  EXPECT_LT(late.of_delay.degrees_of_freedom, 6.0);
  EXPECT_GE(late.of_delay.k, analysis::coverage_factor(late.of_delay.degrees_of_freedom));
  EXPECT_LT(late.of_delay.k, analysis::coverage_factor(2.0));
  EXPECT_GT(same.of_delay.degrees_of_freedom, 6.0);
}

// One sweep at 10 m/s^2, and at 80 Hz other levels, at which the sensor is 1 % off a level and
// late.
TEST(TransferSummary, KeepsLevelsAtAFrequencyApart) {
  const Recipe recipe;
  TransferSummary summary(recipe);
  std::uint32_t step = 0;
  const auto add = [&](double hz, double level_m_s2, double phase_rad) {
    StepResult result;
    result.channel = "dau/acceleration_z";
    result.step = ++step;
    result.repetition = 1;
    result.valid = true;
    result.frequency_hz = hz;
    result.level_m_s2 = level_m_s2;
    result.excited_axis = "z";
    result.magnitude = 1.0 + 0.01 * level_m_s2;
    result.phase_rad = std::remainder(phase_rad, 2.0 * std::numbers::pi);
    result.budget = {{.kind = analysis::ContributionKind::fit_noise,
                      .u_magnitude_rel = 1e-4,
                      .u_phase_rad = 1e-4}};
    summary.add(result);
  };
  const auto line = [](double hz) { return -2.0 * std::numbers::pi * hz * 8e-3; };
  for (const double hz : {20.0, 40.0, 63.0, 80.0, 125.0}) {
    add(hz, 10.0, line(hz));
  }
  for (const double level : {2.0, 4.0, 8.0, 15.0}) {
    add(80.0, level, line(80.0) - 0.1 * level);
  }
  const TransferFunction function = summary.transfer_functions().at(0);
  EXPECT_EQ(function.excited_axis, "z");
  ASSERT_EQ(function.points.size(), 9U);
  ASSERT_TRUE(function.group_delay) << function.group_delay_problem;
  EXPECT_NEAR(function.group_delay->delay_s, 8e-3, 1e-7);
  for (const FrequencyPoint& point : function.points) {
    EXPECT_EQ(point.mean.repetitions, 1U);
    EXPECT_NEAR(point.mean.magnitude, 1.0 + 0.01 * point.level_m_s2, 1e-12);
    const double later = point.level_m_s2 == 10.0 ? 0.0 : 0.1 * point.level_m_s2;
    EXPECT_NEAR(point.unwrapped_phase_rad, line(point.frequency_hz) - later, 1e-9)
        << point.level_m_s2;
  }
}

} // namespace
} // namespace dyncal::inline evaluation
