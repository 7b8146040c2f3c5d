#include "services/views/linearity/amplitude_linearity.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "services/views/linearity/linearity_table.hpp"

namespace dyncal::inline views {
namespace {

using analysis::ContributionKind;
using ::testing::HasSubstr;

constexpr double u_reference_rel = 1e-3;
constexpr double u_noise_rel = 2e-4;

struct Level {
  double level_m_s2 = 0.0;
  double magnitude = 0.0;
  double phase_rad = 0.0;
};

ExpandedUncertainty with_u(double u) {
  return {.u = u, .k = 2.0, .expanded = 2.0 * u};
}

StoredValue value_of(const Level& level) {
  const double u_rel = std::hypot(u_reference_rel, u_noise_rel);
  StoredValue value;
  value.channel = "dau/z";
  value.unit = R"(\one)";
  value.frequency_hz = 80.0;
  value.frequency_text_hz = "80";
  value.level_m_s2 = level.level_m_s2;
  value.magnitude = level.magnitude;
  value.of_magnitude = with_u(level.magnitude * u_rel);
  value.phase_rad = level.phase_rad;
  value.of_phase = with_u(u_rel);
  value.coverage_probability = 0.9545;
  return value;
}

// One repetition a level, of a reference with or without a named contribution.
StoredResult result_of(const std::vector<Level>& levels, const std::string& named = "") {
  StoredResult result;
  result.file = "result.json";
  result.channels.push_back({"dau/z", R"(\one)", true, 0, {}, {}, {}});
  for (const Level& level : levels) {
    StoredPoint point;
    point.channel = "dau/z";
    point.frequency_hz = 80.0;
    point.level_m_s2 = level.level_m_s2;
    point.valid = true;
    point.measured_level_m_s2 = 1.01 * level.level_m_s2;
    point.budget = {{.kind = ContributionKind::reference,
                     .subject = named,
                     .u_magnitude_rel = u_reference_rel,
                     .u_phase_rad = u_reference_rel},
                    {.kind = ContributionKind::fit_noise,
                     .u_magnitude_rel = u_noise_rel,
                     .u_phase_rad = u_noise_rel}};
    result.points.push_back(point);
    result.values.push_back(value_of(level));
  }
  return result;
}

Expected<AmplitudeLinearity> linearity_of(const StoredResult& result,
                                          std::optional<double> level_m_s2 = std::nullopt) {
  return amplitude_linearity_of(result, {"dau/z"}, level_m_s2);
}

TEST(AmplitudeLinearity, IsTheDeviationFromTheHighestLevelWithoutWhatBothShare) {
  const auto linearity =
      linearity_of(result_of({{10, 1.002, 0.101}, {2, 0.99, 0.1}, {50, 1.0, 0.1}}));
  ASSERT_TRUE(linearity) << linearity.error().message;
  ASSERT_EQ(linearity->lines.size(), 1U);
  const LinearityLine& line = linearity->lines.front();
  EXPECT_EQ(line.reference_level_m_s2, 50.0);
  ASSERT_EQ(line.points.size(), 3U);
  EXPECT_EQ(line.points[0].level_m_s2, 2.0);
  EXPECT_NEAR(line.points[0].deviation_rel, -0.01, 1e-12);
  EXPECT_NEAR(line.points[0].expanded_rel, 0.99 * 2.0 * std::sqrt(2.0) * u_noise_rel, 1e-9);
  EXPECT_NEAR(line.points[1].deviation_rel, 0.002, 1e-12);
  EXPECT_NEAR(line.points[1].phase_deviation_rad, 0.001, 1e-12);
  EXPECT_NEAR(line.points[1].expanded_phase_rad, 2.0 * std::sqrt(2.0) * u_noise_rel, 1e-9);
  EXPECT_NEAR(line.points[1].measured_level_m_s2, 10.1, 1e-12);
  EXPECT_FALSE(line.points[2].deviates());
  EXPECT_EQ(line.largest().level_m_s2, 2.0);
}

TEST(AmplitudeLinearity, KeepsWhatTheCertificateNamesBesideTheSensitivity) {
  const auto linearity = linearity_of(result_of({{2, 0.99}, {50, 1.0}}, "amplitude linearity"));
  ASSERT_TRUE(linearity) << linearity.error().message;
  EXPECT_NEAR(linearity->lines.front().points[0].expanded_rel,
              0.99 * 2.0 * std::sqrt(2.0) * std::hypot(u_reference_rel, u_noise_rel), 1e-9);
}

TEST(AmplitudeLinearity, DoesNotReferToAValueThatMayBeWrong) {
  StoredResult result = result_of({{2, 0.99}, {10, 1.0}, {50, 0.9}});
  result.values[2].flag_names = {"over_range"};
  const auto linearity = linearity_of(result);
  ASSERT_TRUE(linearity) << linearity.error().message;
  EXPECT_EQ(linearity->lines.front().reference_level_m_s2, 10.0);
  EXPECT_EQ(linearity->lines.front().points[2].doubting_flag, "over_range");
  EXPECT_THAT(linearity_table(*linearity), HasSubstr("flag over_range: a sine that is cut off"));
  EXPECT_THAT(linearity_table(*linearity), HasSubstr("-10.000     0.051"));
}

TEST(AmplitudeLinearity, TakesTheLevelThatIsAskedFor) {
  const StoredResult result = result_of({{2, 0.99}, {10, 1.0}});
  const auto linearity = linearity_of(result, 2.0);
  ASSERT_TRUE(linearity) << linearity.error().message;
  EXPECT_NEAR(linearity->lines.front().points[1].deviation_rel, 1.0 / 0.99 - 1.0, 1e-12);
  const auto never_measured = linearity_of(result, 3.0);
  ASSERT_FALSE(never_measured);
  EXPECT_THAT(never_measured.error().message, HasSubstr("3 m/s^2"));
}

TEST(AmplitudeLinearity, NeedsTwoLevelsAtAFrequency) {
  EXPECT_FALSE(linearity_of(result_of({{10, 1.0}})));
  EXPECT_FALSE(amplitude_linearity_of(result_of({{2, 1.0}, {10, 1.0}}), {"dau/x"}, std::nullopt));
}

TEST(AmplitudeLinearity, SaysWhichValueHasNoUncertainty) {
  StoredResult result = result_of({{2, 0.99}, {10, 1.0}, {50, 1.0}});
  result.values[0].of_magnitude = {.u = std::nan(""), .k = 2.0, .expanded = std::nan("")};
  const auto linearity = linearity_of(result);
  ASSERT_TRUE(linearity) << linearity.error().message;
  EXPECT_EQ(linearity->lines.front().points.size(), 2U);
  ASSERT_EQ(linearity->notes.size(), 1U);
  EXPECT_EQ(linearity->notes[0].english, "dau/z at 80 Hz, 2 m/s² is left out: it has no U");
  EXPECT_EQ(linearity->notes[0].german, "dau/z bei 80 Hz, 2 m/s² fehlt: der Wert hat kein U");
}

// A linear sensor, with one error of the reference for both levels and noise in each.
TEST(AmplitudeLinearity, CoversTheTruthAndIsNotTooWide) {
  std::mt19937_64 random(37);
  std::normal_distribution<double> normal;
  constexpr int draws = 2000;
  int covered = 0;
  double squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    const double reference = 1.0 + u_reference_rel * normal(random);
    const auto magnitude = [&] { return reference * (1.0 + u_noise_rel * normal(random)); };
    const auto linearity = linearity_of(result_of({{2, magnitude()}, {50, magnitude()}}));
    ASSERT_TRUE(linearity) << linearity.error().message;
    const LinearityPoint& point = linearity->lines.front().points.front();
    covered += std::abs(point.deviation_rel) <= point.expanded_rel ? 1 : 0;
    squares += std::pow(2.0 * point.deviation_rel / point.expanded_rel, 2);
  }
  EXPECT_NEAR(covered / double{draws}, 0.9545, 3.0 * 0.0047);
  EXPECT_NEAR(std::sqrt(squares / draws), 1.0, 0.05);
}

} // namespace
} // namespace dyncal::inline views
