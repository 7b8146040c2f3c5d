#include "services/evaluation/transfer_summary.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/closures/closures.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double pi = std::numbers::pi;
using ::testing::Contains;
using ::testing::Not;

// Three sweeps of four frequencies, each as late as given beside 2 ms, all turned by `turn_rad` and
// beside the line by `beside_rad` at 40 Hz; noise 1e-4 rad.
TransferSummary summary_of(const Recipe& recipe, const std::array<double, 3>& late_s,
                           double turn_rad = 0.0, double beside_rad = 0.0) {
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
      result.u_magnitude = result.u_phase_rad = 1e-4;
      result.phase_rad = std::remainder(-2.0 * pi * hz * (2e-3 + late_s[sweep - 1]) + turn_rad +
                                            (hz == 40.0 ? beside_rad : 0.0),
                                        2.0 * pi);
      result.budget = {{.kind = analysis::ContributionKind::fit_noise,
                        .u_magnitude_rel = 1e-4,
                        .u_phase_rad = 1e-4}};
      summary.add(result);
    }
  }
  return summary;
}

analysis::GroupDelay group_delay_of(const std::array<double, 3>& late_s) {
  const Recipe recipe;
  const auto functions = summary_of(recipe, late_s).transfer_functions();
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

TransferFunction with_closures(DutPhase stated, double turn_rad, double beside_rad) {
  Recipe recipe;
  recipe.dut_phase = stated;
  recipe.frequency_search_rel = 0.0; // results here have no fits
  const TransferSummary summary = summary_of(recipe, {0.0, 0.0, 0.0}, turn_rad, beside_rad);
  auto functions = summary.transfer_functions();
  (void)add_closures({recipe, "", [](const std::string&) { return 0.0; }}, summary.results(),
                     functions);
  return functions.at(0);
}

TEST(TransferSummary, IsInvertedWhereTheBenchFileDoesNotSayThatItIs) {
  const auto flags = [](DutPhase stated, double turn_rad) {
    return names_of(with_closures(stated, turn_rad, 0.0).flags);
  };
  EXPECT_THAT(flags(DutPhase::delay, pi), Contains("polarity_inverted"));
  EXPECT_THAT(flags(DutPhase::delay_from_0, pi), Contains("polarity_inverted"));
  for (const auto& [stated, turn_rad] : {std::pair(DutPhase::delay_from_180, pi),
                                         {DutPhase::any, pi},
                                         {DutPhase::delay, 0.0},
                                         {DutPhase::delay_from_0, 0.0}}) {
    EXPECT_THAT(flags(stated, turn_rad), Not(Contains("polarity_inverted"))) << turn_rad;
  }
}

TEST(TransferSummary, StatesADelayAndItsFlagWhereThePhaseIsThatOfOne) {
  const TransferFunction line = with_closures(DutPhase::delay, 0.0, 0.0);
  ASSERT_TRUE(line.group_delay) << line.group_delay_problem;
  EXPECT_THAT(names_of(line.flags), Not(Contains("group_delay_not_constant")));
  const TransferFunction bent = with_closures(DutPhase::delay, 0.0, 0.05);
  ASSERT_TRUE(bent.group_delay) << bent.group_delay_problem;
  EXPECT_THAT(names_of(bent.flags), Contains("group_delay_not_constant"));
  EXPECT_THAT(names_of(bent.flags), Contains("closure_open"));
  const TransferFunction other = with_closures(DutPhase::any, 0.0, 0.05);
  EXPECT_FALSE(other.group_delay);
  EXPECT_NE(other.group_delay_problem.find("not that of a delay"), std::string::npos);
  EXPECT_THAT(names_of(other.flags), Not(Contains("group_delay_not_constant")));
  EXPECT_NEAR(other.points.back().unwrapped_phase_rad, -2.0 * pi * 125.0 * 2e-3, 1e-9);
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
