#include "services/programs/command/check_view.hpp"

#include <gmock/gmock.h>

namespace dyncal::inline programs {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

CheckView example() {
  std::vector<Calibration> calibrations;
  for (int day = 1; day <= 4; ++day) {
    Calibration one;
    one.run.bench = "b";
    one.run.run = "check-" + std::to_string(day);
    one.run.state = "complete";
    one.run.began_utc = "2026-11-0" + std::to_string(day) + "T08:00:00.000000000Z";
    one.source = "dau";
    for (const double frequency_hz : {10.0, 20.0}) {
      StoredValue value;
      value.channel = "dau/z";
      value.frequency_hz = frequency_hz;
      value.frequency_text_hz = std::to_string(static_cast<int>(frequency_hz));
      value.level_m_s2 = 10.0;
      value.magnitude = 1.0 + 1e-4 * (day % 2);
      value.of_magnitude = {.u = 1e-3, .k = 2.0, .expanded = 2e-3};
      value.phase_rad = -0.1 + 1e-4 * (day % 2);
      value.of_phase = {.u = 1e-3, .k = 2.0, .expanded = 2e-3};
      one.points.push_back(value);
    }
    calibrations.push_back(one);
  }
  CheckView view{
      .sensor = "S-1", .chart = control_chart_of(calibrations, {.first = 3}), .history = {}};
  view.history = history_of("S-1", view.chart.calibrations);
  return view;
}

TEST(CheckView, ShowsEveryLineWithItsLimitsAndTheState) {
  const std::string table = check_table(example());
  EXPECT_THAT(table, AllOf(HasSubstr("S-1 on bench b: 4 results, limits from 3 of"),
                           HasSubstr("newest: run check-4"), HasSubstr("delay of all"),
                           HasSubstr("10 Hz, 10 m/s^2"), HasSubstr("the check: in control")));
  EXPECT_LT(table.find("all points"), table.find("10 Hz"));
}

TEST(CheckView, HasAllDigitsInJson) {
  const auto json = check_json(example());
  EXPECT_EQ(json.at("state"), "in control");
  EXPECT_EQ(json.at("first").size(), 3U);
  ASSERT_EQ(json.at("lines").size(), 6U);
  EXPECT_EQ(json["lines"][0]["values"].size(), 4U);
  EXPECT_TRUE(json["lines"][0]["en"].is_number());
  EXPECT_TRUE(json["lines"][5]["en"].is_null()); // of all points together
  EXPECT_EQ(json["newest"]["run"], "check-4");
}

TEST(CheckView, SaysWhatIsMissing) {
  const CheckView none{.sensor = "S-1", .chart = control_chart_of({}, {}), .history = {}};
  EXPECT_THAT(check_table(none), AllOf(HasSubstr("limits need 10 complete results"),
                                       HasSubstr("the check: too few results")));
  EXPECT_TRUE(check_json(none).at("newest").is_null());
}

TEST(CheckView, EveryStateHasItsExitStatus) {
  EXPECT_EQ(exit_status_of(CheckState::in_control), 0);
  EXPECT_EQ(exit_status_of(CheckState::warning), 5);
  EXPECT_EQ(exit_status_of(CheckState::action), 3);
  EXPECT_EQ(exit_status_of(CheckState::too_few), 4);
}

} // namespace
} // namespace dyncal::inline programs
