#include "services/records/store/history.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline records {
namespace {

StoredValue point(double frequency_hz, double magnitude, double phase_rad) {
  StoredValue point;
  point.channel = "dau/z";
  point.frequency_text_hz = std::to_string(static_cast<int>(frequency_hz));
  point.frequency_hz = frequency_hz;
  point.level_m_s2 = 10.0;
  point.unit = R"(\one)";
  point.magnitude = magnitude;
  point.of_magnitude.expanded = 0.003;
  point.phase_rad = phase_rad;
  point.of_phase.expanded = 0.004;
  return point;
}

Calibration calibration(const std::string& run, std::vector<StoredValue> points) {
  Calibration one;
  one.run.bench = "b";
  one.run.run = run;
  one.source = "dau";
  one.points = std::move(points);
  return one;
}

History history_wanted(std::vector<Calibration> calibrations, const HistoryFilter& filter) {
  for (Calibration& one : calibrations) {
    keep_wanted(one, filter);
  }
  return history_of("s", std::move(calibrations));
}

TEST(History, ComparesEachCalibrationWithTheOneBefore) {
  const History history = history_of("mpu-7", {calibration("r1", {point(10, 1.0, -0.5)}),
                                               calibration("r2", {point(10, 1.002, -0.5)}),
                                               calibration("r3", {point(10, 1.012, -0.5)})});
  ASSERT_EQ(history.lines.size(), 1U);
  const auto& values = history.lines.front().values;
  ASSERT_EQ(values.size(), 3U);
  EXPECT_FALSE(values[0].en_magnitude);
  EXPECT_TRUE(values[0].agrees());
  EXPECT_NEAR(*values[1].en_magnitude, 0.002 / std::hypot(0.003, 0.003), 1e-9);
  EXPECT_TRUE(values[1].agrees());
  EXPECT_NEAR(*values[2].en_magnitude, 0.010 / std::hypot(0.003, 0.003), 1e-9);
  EXPECT_FALSE(values[2].agrees());
  EXPECT_NEAR(values[2].deviation_magnitude_rel, 0.012, 1e-12);
  EXPECT_NEAR(*values[2].en_phase, 0.0, 1e-12);
}

// U 0.3 %, of which the reference alone is 0.29 %: a change of 0.25 % is one.
TEST(History, TakesOutWhatBothHaveInCommon) {
  std::vector<Calibration> two{calibration("r1", {point(10, 1.0, 0.0)}),
                               calibration("r2", {point(10, 1.0025, 0.0)})};
  for (Calibration& one : two) {
    one.points[0].of_magnitude = {.u = 0.0015, .k = 2.0, .expanded = 0.003};
    one.points[0].of_phase = {.u = 0.002, .k = 2.0, .expanded = 0.004};
  }
  const auto newest = [&] { return history_of("s", two).lines.front().values.back(); };
  EXPECT_NEAR(*newest().en_magnitude, 0.0025 / std::hypot(0.003, 0.003), 1e-9);
  EXPECT_TRUE(newest().agrees());
  for (Calibration& one : two) {
    one.common[{.channel = "dau/z", .frequency_hz = 10.0, .level_m_s2 = 10.0}] = {
        .origin = "certificate of 2026", .rows = {{"reference", 0.00145, 0.0}}};
  }
  const double u2 = 2.0 * (0.0015 * 0.0015) - 2.0 * 0.00145 * 0.00145 * 1.0025;
  EXPECT_NEAR(*newest().en_magnitude, 0.0025 / (2.0 * std::sqrt(u2)), 1e-6);
  EXPECT_FALSE(newest().agrees());
  two.back().common.begin()->second.rows[0].u_magnitude_rel = 0.1; // another row
  EXPECT_TRUE(newest().agrees());
  for (Calibration& one : two) { // more than all of U: a budget of another version
    one.common.begin()->second.rows[0].u_magnitude_rel = 0.002;
  }
  ASSERT_TRUE(newest().en_magnitude);
  EXPECT_TRUE(std::isfinite(*newest().en_magnitude));
}

TEST(History, TakesThePhaseModuloOneTurn) {
  const double turn = 2.0 * std::numbers::pi;
  const History history =
      history_of("s", {calibration("r1", {point(10, 1.0, -3.14)}),
                       calibration("r2", {point(10, 1.0, -3.14 + turn - 0.002)})});
  const HistoryValue& value = history.lines.front().values.back();
  EXPECT_NEAR(value.deviation_phase_rad, -0.002, 1e-9);
  EXPECT_TRUE(value.agrees());
}

TEST(History, DoesNotCompareWhatCannotBe) {
  StoredValue other_unit = point(10, 2.0, 0.0);
  other_unit.unit = R"(\volt)";
  const History history =
      history_of("s", {calibration("r1", {point(10, 1.0, 0.0)}), calibration("r2", {other_unit}),
                       calibration("r2", {other_unit})});
  const auto& values = history.lines.front().values;
  ASSERT_EQ(values.size(), 3U);
  EXPECT_FALSE(values[1].en_magnitude);
  EXPECT_FALSE(values[2].en_magnitude); // another evaluation of the same run
}

TEST(History, KeepsLevelsAndAxesApart) {
  std::vector<StoredValue> levels;
  for (const double level : {2.0, 4.0, 8.0, 12.0, 15.0}) {
    levels.push_back(point(80, 1.0 + 0.01 * level, 0.0));
    levels.back().level_m_s2 = level;
  }
  std::vector<StoredValue> along_z = levels;
  for (StoredValue& value : along_z) {
    value.excited_axis = "z";
  }
  const std::vector<Calibration> twice{calibration("r1", levels), calibration("r2", levels)};
  const History history = history_of("s", twice);
  ASSERT_EQ(history.lines.size(), 5U);
  EXPECT_TRUE(history.differences().levels);
  EXPECT_FALSE(history.differences().axes);
  for (const HistoryLine& line : history.lines) {
    ASSERT_EQ(line.values.size(), 2U);
    EXPECT_EQ(line.values[1].deviation_magnitude_rel, 0.0);
    EXPECT_EQ(*line.values[1].en_magnitude, 0.0);
  }
  EXPECT_EQ(history.lines[4].point.level_m_s2, 15.0);
  EXPECT_EQ(history_wanted(twice, {.level_m_s2 = 8.0}).lines.size(), 1U);
  const History axes = history_of("s", {calibration("r1", levels), calibration("r2", along_z)});
  EXPECT_EQ(axes.lines.size(), 10U);
  EXPECT_TRUE(axes.differences().axes);
}

TEST(History, HasTheOpenClosuresOfTheChannelsThatItShows) {
  Calibration one = calibration("r1", {point(10, 1.0, 0.0)});
  one.open_closures = {{"dau/z", "dau/z: level: off"}, {"dau/y", "dau/y: level: off"}};
  const History history = history_of("s", {one});
  ASSERT_EQ(history.calibrations[0].open_closures.size(), 1U);
  EXPECT_EQ(history.calibrations[0].open_closures[0].sentence, "dau/z: level: off");
}

TEST(History, LeavesOutWhatIsNotKnown) {
  StoredValue unknown = point(10, std::nan(""), 0.0);
  StoredValue without_u = point(10, 1.0, 0.0);
  without_u.of_phase.expanded = std::nan("");
  EXPECT_TRUE(history_of("s", {calibration("r1", {unknown, without_u})}).lines.empty());
}

TEST(History, ShowsOneChannelAndFrequencyIfAsked) {
  StoredValue y = point(10, 1.0, 0.0);
  y.channel = "dau/y";
  const std::vector<Calibration> all{
      calibration("r1", {point(20, 1.0, 0.0), point(10, 1.0, 0.0), y})};
  EXPECT_EQ(history_of("s", all).lines.size(), 3U);
  EXPECT_EQ(history_of("s", all).lines[1].point.frequency_hz, 10.0);
  EXPECT_EQ(history_wanted(all, {.channel = "dau/z"}).lines.size(), 2U);
  EXPECT_EQ(history_wanted(all, {.channel = "dau/z", .frequency_hz = 20.0}).lines.size(), 1U);
  EXPECT_TRUE(history_wanted(all, {.channel = "dau/z", .frequency_hz = 30.0}).lines.empty());
}

} // namespace
} // namespace dyncal::inline records
