#include "services/records/store/control_chart.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>

namespace dyncal::inline records {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int points = 17;

struct Day {
  double drift_rel = 0.0;
  double delay_s = 0.0;
};

// Daily checks: points scatter by 0.05 %, the whole channel from day to day by 0.02 %. The error of
// the reference, 0.1 % (U 0.2 %), is the same on all days.
class Bench {
public:
  explicit Bench(unsigned seed) : bits_(seed) {}

  Calibration measure(const Day& day = {}) {
    Calibration one;
    one.run.bench = "b";
    one.run.run = fmt::format("check-{}", ++runs_);
    one.run.state = "complete";
    one.run.began_utc = fmt::format("2026-11-{:02}T08:00:00.000000000Z", runs_);
    one.run.software = "dyncal 0.3.0";
    one.source = "dau";
    const double of_day = 2e-4 * normal_(bits_);
    for (int i = 1; i <= points; ++i) {
      StoredValue value;
      value.channel = "dau/z";
      value.frequency_hz = 10.0 * i;
      value.frequency_text_hz = std::to_string(10 * i);
      value.level_m_s2 = 10.0;
      value.unit = R"(\one)";
      value.magnitude = reference_ * (1.0 + day.drift_rel) * (1.0 + of_day + 5e-4 * normal_(bits_));
      value.of_magnitude = {.u = 1.1e-3, .k = 2.0, .expanded = 2.2e-3};
      value.phase_rad =
          std::remainder(-2.0 * std::numbers::pi * value.frequency_hz * (8.1e-3 + day.delay_s) +
                             5e-4 * normal_(bits_),
                         2.0 * std::numbers::pi);
      value.of_phase = {.u = 1.1e-3, .k = 2.0, .expanded = 2.2e-3};
      one.points.push_back(value);
    }
    return one;
  }

  std::vector<Calibration> days(std::size_t count) {
    std::vector<Calibration> all;
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(measure());
    }
    return all;
  }

private:
  std::mt19937 bits_;
  std::normal_distribution<double> normal_;
  double reference_ = 1.0 + 1e-3 * normal_(bits_);
  int runs_ = 0;
};

CheckState state_after(unsigned seed, const Day& day, std::size_t first = 10) {
  Bench bench(seed);
  std::vector<Calibration> all = bench.days(first);
  all.push_back(bench.measure(day));
  return control_chart_of(std::move(all), {.first = first}).state;
}

TEST(ControlChart, FindsADriftAndAlarmsForNothingElse) {
  int found = 0;
  int found_delay = 0;
  int warnings = 0;
  int alarms = 0;
  for (unsigned draw = 1; draw <= 100; ++draw) {
    found += state_after(draw, {.drift_rel = 2.5e-3}) == CheckState::action ? 1 : 0;
    found_delay += state_after(1000 + draw, {.delay_s = 5e-6}) == CheckState::action ? 1 : 0;
    const CheckState without = state_after(2000 + draw, {});
    alarms += without == CheckState::action ? 1 : 0;
    warnings += without == CheckState::warning ? 1 : 0;
  }
  RecordProperty("found", found);
  RecordProperty("found_delay", found_delay);
  RecordProperty("alarms", alarms);
  RecordProperty("warnings", warnings);
  EXPECT_GE(found, 95);
  EXPECT_GE(found_delay, 95);
  EXPECT_LE(alarms, 5);
  EXPECT_LE(warnings, 12) << "of 4.3 expected; more by chance once in 1000";
}

TEST(ControlChart, FewResultsHaveWideLimitsAndDoNotAlarmMore) {
  int alarms = 0;
  for (unsigned draw = 1; draw <= 100; ++draw) {
    alarms += state_after(3000 + draw, {}, 3) == CheckState::action ? 1 : 0;
  }
  EXPECT_LE(alarms, 5);
}

TEST(ControlChart, TooFewResultsAreSaid) {
  Bench bench(1);
  const ControlChart none = control_chart_of({}, {});
  EXPECT_EQ(none.state, CheckState::too_few);
  const ControlChart few = control_chart_of(bench.days(10), {.first = 10}); // nine before
  EXPECT_EQ(few.state, CheckState::too_few);
  EXPECT_THAT(few.notes, Contains(HasSubstr("need 10 complete results before the newest one; "
                                            "there are 9")));
  EXPECT_EQ(control_chart_of(bench.days(11), {.first = 10}).state, CheckState::in_control);
}

TEST(ControlChart, StatesEachLine) {
  Bench bench(2);
  const ControlChart chart = control_chart_of(bench.days(12), {.first = 10});
  ASSERT_EQ(chart.lines.size(), 2U * points + 2U);
  const ControlLine& line = chart.lines.front();
  EXPECT_EQ(line.quantity, ControlQuantity::magnitude);
  EXPECT_NEAR(line.centre, 1.0, 5e-3);
  EXPECT_NEAR(line.s, 5.4e-4, 4e-4);
  EXPECT_GT(line.action, line.warning);
  EXPECT_EQ(line.values.size(), 12U);
  ASSERT_TRUE(line.newest);
  EXPECT_EQ(line.newest->calibration, 11U);
  EXPECT_EQ(chart.lines.back().quantity, ControlQuantity::delay);
  EXPECT_LT(chart.lines[2 * points].s, line.s); // the mean of 17 points
  double sum = 0.0;
  for (std::size_t i = 0; i < 10; ++i) {
    sum += line.values[i].deviation;
  }
  EXPECT_NEAR(sum, 0.0, 1e-12);
}

TEST(ControlChart, IgnoresOtherBenchesOldResultsAndOtherEvaluations) {
  Bench bench(3);
  std::vector<Calibration> all = bench.days(4);
  Calibration elsewhere = bench.measure({.drift_rel = 0.1});
  elsewhere.run.bench = "other";
  all.insert(all.begin() + 2, elsewhere);
  all.push_back(all.front()); // the same run by another recipe
  all.back().points.front().magnitude *= 1.1;
  const ControlChart chart = control_chart_of(all, {.first = 3});
  EXPECT_EQ(chart.bench, "b");
  EXPECT_EQ(chart.calibrations.size(), 4U);
  EXPECT_EQ(chart.state, CheckState::in_control);
  // After service of the exciter limits begin again.
  const std::vector<Calibration> later = bench.days(6); // of the days 6 to 11
  EXPECT_EQ(control_chart_of(later, {.first = 3}).state, CheckState::in_control);
  const ControlChart since = control_chart_of(later, {.first = 3, .since_utc = "2026-11-09"});
  EXPECT_EQ(since.calibrations.size(), 3U);
  EXPECT_EQ(since.state, CheckState::too_few);
}

TEST(ControlChart, JudgesOnlyWhatAllFirstResultsHave) {
  Bench bench(4);
  std::vector<Calibration> all = bench.days(12);
  all[3].points.erase(all[3].points.begin());       // another frequency list
  all[11].points.erase(all[11].points.begin() + 1); // and another
  all[11].points.back().level_m_s2 = 5.0;           // another level
  const ControlChart chart = control_chart_of(all, {.first = 10});
  EXPECT_EQ(chart.state, CheckState::in_control);
  EXPECT_EQ(chart.lines.size(), 2U * (points - 1) + 2U);
  EXPECT_THAT(chart.notes, Contains(HasSubstr("not in the newest result: dau/z at 20 Hz")));
  EXPECT_THAT(chart.notes, Contains(HasSubstr("not all of the first results have it: dau/z at "
                                              "10 Hz")));
  EXPECT_THAT(chart.notes, Contains(HasSubstr("170 Hz, 5 m/s^2")));
}

TEST(ControlChart, AFlagOfTheNewestResultWarns) {
  Bench bench(5);
  std::vector<Calibration> all = bench.days(11);
  all.back().points.front().flag_names = {"over_range"};
  const ControlChart chart = control_chart_of(all, {.first = 10});
  EXPECT_EQ(chart.state, CheckState::warning);
  EXPECT_THAT(chart.notes, Contains(HasSubstr("10 Hz, 10 m/s^2 (flag over_range)")));
  for (Calibration& one : all) { // always: that point is not judged at all
    one.points.front().flag_names = {"over_range"};
  }
  EXPECT_EQ(control_chart_of(all, {.first = 10}).state, CheckState::in_control);
  all.back().points.front().flag_names = {"shots_missing"};
  EXPECT_EQ(control_chart_of(all, {.first = 10}).state, CheckState::in_control);
}

TEST(ControlChart, IncompleteResultsAreNoLimits) {
  Bench bench(6);
  std::vector<Calibration> all = bench.days(11);
  all[4].run.state = "interrupted";
  EXPECT_EQ(control_chart_of(all, {.first = 10}).state, CheckState::too_few);
}

TEST(ControlChart, ChannelsThatDoNotRespondAreNotJudged) {
  Bench bench(7);
  std::vector<Calibration> all = bench.days(11);
  for (Calibration& one : all) {
    for (int i = 0; i < points; ++i) {
      StoredValue across = one.points[static_cast<std::size_t>(i)];
      across.channel = "dau/x";
      across.magnitude = 1e-3;
      one.points.push_back(across);
    }
  }
  EXPECT_EQ(control_chart_of(all, {.first = 10}).lines.size(), 2U * points + 2U);
}

TEST(ControlChart, GivenLimitsTakeThePlaceOfScatter) {
  Bench bench(8);
  std::vector<Calibration> all = bench.days(10);
  all.push_back(bench.measure({.drift_rel = 8e-3}));
  ControlOptions options{.first = 10, .limit_magnitude_rel = 0.01, .limit_phase_rad = 0.01};
  const ControlChart chart = control_chart_of(all, options);
  EXPECT_EQ(chart.lines.size(), 2U * points); // none of the whole channel
  EXPECT_EQ(chart.lines[0].action, 0.01);
  EXPECT_NEAR(chart.lines[0].warning, 0.01 * 2.0 / 3.0, 1e-12);
  EXPECT_EQ(chart.state, CheckState::warning);
  all.push_back(bench.measure({.drift_rel = -0.02}));
  EXPECT_EQ(control_chart_of(all, options).state, CheckState::action);
}

TEST(ControlChart, SaysWhatHasChangedSinceTheFirstResults) {
  Bench bench(9);
  std::vector<Calibration> all = bench.days(11);
  EXPECT_THAT(control_chart_of(all, {.first = 10}).notes, IsEmpty());
  all.back().run.software = "dyncal 0.4.0";
  const PointIdentity point{.channel = "dau/z", .frequency_hz = 10.0, .level_m_s2 = 10.0};
  for (Calibration& one : all) {
    one.common[point] = {.origin = "reference of 2024", .rows = {}};
  }
  all.back().common[point].origin = "reference of 2026";
  const auto notes = control_chart_of(all, {.first = 10}).notes;
  EXPECT_THAT(notes, Contains(HasSubstr("by dyncal 0.3.0, the newest by dyncal 0.4.0")));
  EXPECT_THAT(notes, Contains(HasSubstr("instruments or corrections are not those")));
}

TEST(ControlChart, EqualResultsAreInControl) {
  Bench bench(10);
  const Calibration one = bench.measure();
  std::vector<Calibration> all(5, one);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].run.run = std::to_string(i);
  }
  EXPECT_EQ(control_chart_of(all, {.first = 3}).state, CheckState::in_control);
}

} // namespace
} // namespace dyncal::inline records
