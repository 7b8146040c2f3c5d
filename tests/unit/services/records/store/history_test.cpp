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
  StoredValue other_level = other_unit;
  other_level.level_m_s2 = 100.0;
  const History history =
      history_of("s", {calibration("r1", {point(10, 1.0, 0.0)}), calibration("r2", {other_unit}),
                       calibration("r3", {other_level}), calibration("r3", {other_level})});
  const auto& values = history.lines.front().values;
  ASSERT_EQ(values.size(), 4U);
  EXPECT_FALSE(values[1].en_magnitude);
  EXPECT_FALSE(values[2].en_magnitude);
  EXPECT_FALSE(values[3].en_magnitude); // another evaluation of the same run
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
  EXPECT_EQ(history_of("s", all).lines[1].frequency_hz, 10.0);
  EXPECT_EQ(history_of("s", all, "dau/z").lines.size(), 2U);
  EXPECT_EQ(history_of("s", all, "dau/z", 20.0).lines.size(), 1U);
  EXPECT_TRUE(history_of("s", all, "dau/z", 30.0).lines.empty());
}

} // namespace
} // namespace dyncal::inline records
