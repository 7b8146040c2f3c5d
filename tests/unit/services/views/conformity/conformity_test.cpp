#include "services/views/conformity/conformity.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using enum analysis::ConformityStatement;

const std::string channel = "dau/z";

StoredValue value_at(double frequency_hz, double magnitude, double phase_deg = 0.0) {
  StoredValue value;
  value.channel = channel;
  value.frequency_hz = frequency_hz;
  value.frequency_text_hz = std::to_string(static_cast<int>(frequency_hz));
  value.level_m_s2 = 10.0;
  value.magnitude = magnitude;
  value.of_magnitude = {.u = 0.005, .k = 2.0, .expanded = 0.01};
  value.phase_rad = phase_deg * std::numbers::pi / 180.0;
  value.of_phase = {.u = 0.005, .k = 2.0, .expanded = 0.01};
  value.coverage_probability = 0.9545;
  return value;
}

StoredResult result_of(std::vector<StoredValue> values) {
  StoredResult result;
  result.channels.push_back({channel, R"(\one)", true, 0, {}, {}, {}});
  for (const StoredValue& value : values) {
    StoredStep step;
    step.frequency_text_hz = value.frequency_text_hz;
    step.frequency_hz = value.frequency_hz;
    step.level_m_s2 = value.level_m_s2;
    result.steps.push_back(step);
  }
  result.values = std::move(values);
  return result;
}

Tolerances tolerances(std::vector<ToleranceRow> rows) {
  return {"data sheet", analysis::DecisionRule::guard_band, 1.0, std::move(rows)};
}

ToleranceRow percent_row(double from_hz, double to_hz, double limit) {
  return {.from_hz = from_hz, .to_hz = to_hz, .lower = -limit, .upper = limit, .nominal = 1.0};
}

ConformityReport judged(const StoredResult& result, std::vector<ToleranceRow> rows) {
  return judge_conformity(result, {channel}, tolerances(std::move(rows)));
}

std::vector<std::string> english_of(const std::vector<TranslatedText>& texts) {
  std::vector<std::string> english;
  english.reserve(texts.size());
  for (const TranslatedText& text : texts) {
    english.push_back(text.english);
  }
  return english;
}

TEST(Conformity, JudgesEveryValueInTheRange) {
  const ConformityReport report =
      judged(result_of({value_at(10, 1.03), value_at(20, 1.045), value_at(40, 0.94)}),
             {percent_row(10, 40, 5)});
  ASSERT_EQ(report.values.size(), 3U);
  EXPECT_EQ(report.values[0].statement, pass);
  EXPECT_EQ(report.values[1].statement, fail); // within the limit, not within it less U
  EXPECT_EQ(report.values[2].statement, fail);
  EXPECT_NEAR(report.values[0].deviation, 3.0, 1e-9);
  EXPECT_NEAR(report.values[0].expanded, 1.0, 1e-9);
  EXPECT_NEAR(report.values[1].probability, 0.841344746, 1e-6); // one u
  EXPECT_EQ(report.statement(), fail);
  EXPECT_THAT(report.notes, IsEmpty());
}

TEST(Conformity, BothLimitsHoldWhereRowsMeet) {
  const StoredResult result = result_of({value_at(10, 1.0), value_at(20, 1.03), value_at(40, 1.0)});
  const ConformityReport report = judged(result, {percent_row(10, 20, 5), percent_row(20, 40, 2)});
  ASSERT_EQ(report.values.size(), 4U);
  EXPECT_EQ(report.values[1].frequency_hz, 20.0);
  EXPECT_EQ(report.values[1].statement, pass);
  EXPECT_EQ(report.values[2].frequency_hz, 20.0);
  EXPECT_EQ(report.values[2].row, 1U);
  EXPECT_EQ(report.values[2].statement, fail);
}

TEST(Conformity, ADoubtAboutThePhaseLeavesTheMagnitudeDecided) {
  StoredValue value = value_at(10, 1.0);
  value.flag_names = {"adc_not_calibrated"};
  ToleranceRow phase = percent_row(10, 40, 5);
  phase.unit = ToleranceUnit::degree;
  const ConformityReport report = judged(result_of({value}), {percent_row(10, 40, 5), phase});
  ASSERT_EQ(report.values.size(), 2U);
  EXPECT_EQ(report.values[0].statement, pass);
  EXPECT_EQ(report.values[1].statement, undecided);
  EXPECT_THAT(report.values[1].reason.english, HasSubstr("adc_not_calibrated"));
}

TEST(Conformity, SaysWhatNoLimitAndWhatNoValueIsFor) {
  const ConformityReport report = judged(result_of({value_at(10, 1.0), value_at(80, 1.0)}),
                                         {percent_row(10, 20, 5), percent_row(100, 200, 5)});
  EXPECT_THAT(english_of(report.notes),
              UnorderedElementsAre(HasSubstr("limit 2 (magnitude, 100 Hz to 200 Hz): no value"),
                                   "dau/z: no limit of the magnitude applies at 80 Hz"));
  EXPECT_EQ(report.statement(), undecided); // a limit was not measured
  ToleranceRow other = percent_row(10, 200, 5);
  other.channel = "dau/y";
  EXPECT_THAT(english_of(judged(result_of({value_at(10, 1.0)}), {other}).notes),
              UnorderedElementsAre(HasSubstr("limit 1"), "dau/z: no limit is for this channel"));
}

TEST(Conformity, IsUndecidedWithoutUAndWithARefusingFlag) {
  StoredValue without_u = value_at(10, 1.0);
  without_u.of_magnitude.expanded = without_u.of_magnitude.u = std::nan("");
  StoredValue flagged = value_at(20, 1.0);
  flagged.flag_names = {"over_range"};
  StoredResult result = result_of({without_u, flagged, value_at(40, 1.0), value_at(80, 1.0)});
  StoredPoint point;
  point.channel = channel;
  point.frequency_hz = 40;
  point.level_m_s2 = 10.0;
  point.valid = true;
  point.flag_names = {"samples_lost"};
  result.points = {point};
  const ConformityReport report = judged(result, {percent_row(10, 80, 5)});
  ASSERT_EQ(report.values.size(), 4U);
  EXPECT_EQ(report.values[0].statement, undecided);
  EXPECT_THAT(report.values[0].reason.english, HasSubstr("no value with a usable U"));
  EXPECT_EQ(report.values[1].statement, undecided);
  EXPECT_THAT(report.values[1].reason.english, HasSubstr("flag over_range"));
  EXPECT_TRUE(std::isnan(report.values[1].probability));
  EXPECT_EQ(report.values[2].statement, undecided); // of a single result
  EXPECT_EQ(report.values[3].statement, pass);
  EXPECT_EQ(report.statement(), undecided);
  result.channels[0].flag_names = {"closure_open"};
  EXPECT_EQ(judged(result, {percent_row(80, 80, 5)}).statement(), undecided);
  result.channels[0].flag_names = {"shots_missing"}; // which refuses nothing
  EXPECT_EQ(judged(result, {percent_row(80, 80, 5)}).statement(), pass);
}

TEST(Conformity, IsUndecidedWhereAPlannedPointHasNoValue) {
  StoredResult result = result_of({value_at(10, 1.0), value_at(20, 1.0)});
  result.values.pop_back();
  const ConformityReport report = judged(result, {percent_row(10, 20, 5)});
  ASSERT_EQ(report.values.size(), 2U);
  EXPECT_EQ(report.values[1].statement, undecided);
  EXPECT_THAT(report.values[1].reason.english, HasSubstr("planned"));
  EXPECT_EQ(report.statement(), undecided);
  EXPECT_EQ(judged(result_of({}), {percent_row(10, 20, 5)}).statement(), undecided);
}

TEST(Conformity, KeepsLevelsApart) {
  StoredValue low = value_at(80, 1.0);
  low.level_m_s2 = 2.0;
  StoredValue high = value_at(80, 1.04);
  ToleranceRow row = percent_row(80, 80, 2);
  row.from_level_m_s2 = 1.0;
  row.to_level_m_s2 = 2.0;
  const ConformityReport report = judged(result_of({low, high}), {row});
  ASSERT_EQ(report.values.size(), 1U);
  EXPECT_EQ(report.statement(), pass);
  EXPECT_THAT(english_of(report.notes),
              ElementsAre("dau/z: no limit of the magnitude applies at 80 Hz, 10 m/s^2"));
}

TEST(Conformity, TakesDecibelAsLimitsOfTheRatio) {
  ToleranceRow row = percent_row(10, 80, 0);
  row.unit = ToleranceUnit::decibel;
  row.lower = -3.0;
  row.upper = 1.0;
  const double at_limit = std::pow(10.0, 1.0 / 20.0);
  const ConformityReport report =
      judged(result_of({value_at(10, at_limit - 0.0101), value_at(20, at_limit - 0.0099),
                        value_at(40, std::pow(10.0, -3.0 / 20.0) + 0.0101)}),
             {row});
  ASSERT_EQ(report.values.size(), 3U);
  EXPECT_EQ(report.values[0].statement, pass);
  EXPECT_EQ(report.values[1].statement, fail);
  EXPECT_EQ(report.values[2].statement, pass);
  EXPECT_NEAR(report.values[1].deviation, 20.0 * std::log10(at_limit - 0.0099), 1e-12);
  EXPECT_NEAR(report.values[1].expanded, 20.0 / std::log(10.0) * 0.01 / (at_limit - 0.0099), 1e-9);
}

TEST(Conformity, ComparesWithTheValueAtTheReferenceFrequency) {
  ToleranceRow row = percent_row(10, 80, 5);
  row.relative_to_hz = 40.0;
  StoredResult result = result_of({value_at(10, 2.0), value_at(40, 2.0), value_at(80, 2.08)});
  const ConformityReport report = judged(result, {row});
  ASSERT_EQ(report.values.size(), 2U); // not the reference with itself
  EXPECT_NEAR(report.values[1].deviation, 4.0, 1e-9);
  EXPECT_NEAR(report.values[1].expanded, std::hypot(0.5, 0.5 * 1.04), 1e-9);
  EXPECT_EQ(report.values[1].statement, pass);
  result.values[1].flag_names = {"over_range"};
  EXPECT_THAT(judged(result, {row}).values[0].reason.english,
              HasSubstr("at the reference frequency"));
  row.relative_to_hz = 63.0;
  const ConformityReport without = judged(result, {row});
  ASSERT_EQ(without.values.size(), 3U);
  EXPECT_THAT(without.values[0].reason.english,
              HasSubstr("no value at the reference frequency of 63 Hz"));
  EXPECT_EQ(without.statement(), undecided);
}

TEST(Conformity, TakesThePhaseModuloOneTurn) {
  const double delay_s = 8.1e-3;
  ToleranceRow row{.from_hz = 10,
                   .to_hz = 200,
                   .unit = ToleranceUnit::degree,
                   .lower = -2.0,
                   .upper = 2.0,
                   .nominal_deg = 180.0,
                   .nominal_delay_s = delay_s};
  const auto phase = [&](double frequency_hz, double off_deg) {
    return value_at(frequency_hz, 1.0,
                    std::remainder(180.0 - 360.0 * frequency_hz * delay_s + off_deg, 360.0));
  };
  const StoredResult result = result_of({phase(10, 1.0), phase(200, -1.0), phase(100, 3.0)});
  const ConformityReport report = judged(result, {row});
  ASSERT_EQ(report.values.size(), 3U);
  EXPECT_NEAR(report.values[0].deviation, 1.0, 1e-9);
  EXPECT_NEAR(report.values[1].deviation, -1.0, 1e-9);
  EXPECT_NEAR(report.values[0].expanded, 0.01 * 180.0 / std::numbers::pi, 1e-9);
  EXPECT_EQ(report.values[0].statement, pass);
  EXPECT_EQ(report.values[2].statement, fail);
}

TEST(Conformity, SaysWhereNothingCouldPass) {
  const ConformityReport report =
      judged(result_of({value_at(10, 1.0)}), {percent_row(10, 10, 0.9)});
  EXPECT_EQ(report.values.at(0).statement, fail);
  EXPECT_THAT(report.values[0].reason.english, HasSubstr("nothing could pass"));
}

} // namespace
} // namespace dyncal::inline views
