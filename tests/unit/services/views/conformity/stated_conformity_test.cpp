#include "services/views/conformity/stated_conformity.hpp"

#include <gmock/gmock.h>

#include "services/views/conformity/conformity_json.hpp"
#include "services/views/conformity/conformity_table.hpp"

namespace dyncal::inline views {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using enum analysis::ConformityStatement;

ConformityReport example() {
  ConformityReport report;
  report.tolerances = {"data sheet", analysis::DecisionRule::guard_band, 1.0, {}};
  report.tolerances.rows = {{.from_hz = 10, .to_hz = 63, .lower = -5, .upper = 5, .nominal = 1.0},
                            {.channel = "dau/z",
                             .from_hz = 80,
                             .to_hz = 80,
                             .from_level_m_s2 = 2,
                             .to_level_m_s2 = 15,
                             .unit = ToleranceUnit::degree,
                             .lower = -2,
                             .upper = 2,
                             .nominal_delay_s = 0.0081}};
  report.values = {{.channel = "dau/z",
                    .frequency_text_hz = "10",
                    .frequency_hz = 10,
                    .level_m_s2 = 10,
                    .row = 0,
                    .statement = pass,
                    .deviation = 1.23456,
                    .expanded = 0.214,
                    .k = 2,
                    .probability = 0.99999},
                   {.channel = "dau/z",
                    .frequency_text_hz = "80",
                    .frequency_hz = 80,
                    .level_m_s2 = 10,
                    .row = 1,
                    .reason = {"flag over_range: \x1b[2J", "Kennzeichnung over_range"}}};
  return report;
}

TEST(StatedConformity, SaysRangesAndLimits) {
  const ConformityReport report = example();
  EXPECT_EQ(row_text(report.tolerances.rows[0]), "magnitude, 10 Hz to 63 Hz: -5 % to 5 % from 1");
  EXPECT_EQ(row_text(report.tolerances.rows[1]),
            "phase, 80 Hz, 2 m/s^2 to 15 m/s^2: -2 deg to 2 deg from 0 deg - 360 deg f x 0.0081 s");
  EXPECT_EQ(verdict_text(report), "data sheet: undecided (1 pass, 1 undecided)");
}

TEST(StatedConformity, SaysItInGerman) {
  const ConformityReport report = example();
  EXPECT_EQ(row_text(report.tolerances.rows[1], Language::german),
            "Phasenverschiebung, 80 Hz, 2 m/s^2 bis 15 m/s^2: -2 deg bis 2 deg von 0 deg - 360 deg "
            "f x 0,0081 s");
  EXPECT_EQ(verdict_text(report, Language::german),
            "data sheet: nicht entschieden (1 konform, 1 nicht entschieden)");
  EXPECT_EQ(probability_text({.probability = 0.8413}, Language::german), "84,1 %");
}

TEST(StatedConformity, RoundsByU) {
  const ConformityReport report = example();
  EXPECT_EQ(stated_deviation(report.values[0]).value, "1.23");
  EXPECT_EQ(stated_deviation(report.values[0]).expanded, "0.21");
  EXPECT_EQ(stated_deviation(report.values[1]).value, "");
  EXPECT_EQ(probability_text(report.values[0]), "> 99.9 %");
  EXPECT_EQ(probability_text(report.values[1]), "");
  EXPECT_EQ(probability_text({.probability = 0.8413}), "84.1 %");
  EXPECT_EQ(probability_text({.probability = 1e-9}), "< 0.1 %");
}

TEST(StatedConformity, EveryRuleHasItsSentence) {
  Tolerances tolerances = example().tolerances;
  EXPECT_THAT(rule_text(tolerances), AllOf(HasSubstr("less w = 1 U"), HasSubstr("2.3 %")));
  tolerances.guard_factor = 0.5;
  EXPECT_THAT(rule_text(tolerances), Not(HasSubstr("2.3 %")));
  tolerances.rule = analysis::DecisionRule::simple_acceptance;
  EXPECT_THAT(rule_text(tolerances), HasSubstr("50 %"));
  tolerances.rule = analysis::DecisionRule::guard_band_non_binary;
  EXPECT_THAT(rule_text(tolerances), HasSubstr("conditional"));
}

TEST(ConformityTable, HasEveryValueAndNoControlCharacter) {
  const std::string table = conformity_table(example());
  EXPECT_THAT(table, AllOf(HasSubstr("> 99.9 %  pass"), HasSubstr("undecided: flag over_range"),
                           HasSubstr("data sheet: undecided"), HasSubstr("dau/z, limit 2")));
  EXPECT_EQ(table.find('\x1b'), std::string::npos);
}

TEST(ConformityJson, HasAllDigits) {
  StoredResult result;
  result.sha256 = "abc";
  const auto json = conformity_json(example(), result);
  ASSERT_EQ(json.at("values").size(), 2U);
  EXPECT_EQ(json["values"][0]["deviation"], 1.23456);
  EXPECT_EQ(json["values"][0]["statement"], "pass");
  EXPECT_TRUE(json["values"][1]["probability"].is_null());
  EXPECT_EQ(json["statement"], "undecided");
  EXPECT_EQ(json["result_sha256"], "abc");
}

} // namespace
} // namespace dyncal::inline views
