#include "services/views/lab_file/tolerance_table.hpp"

#include <array>

#include <gmock/gmock.h>

#include "services/views/lab_file/sensor_file.hpp"

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;

const std::string rule = "[conformity]\nspecification = \"data sheet\"\nrule = \"guard-band\"\n";
const std::string row = "[[tolerance]]\nfrom_hz = 10\nto_hz = 63\n";

TEST(ToleranceTable, ReadsRows) {
  const auto read = parse_tolerance_file(
      rule + "guard_factor = 0.83\n" + row + "limits_percent = 5\nnominal = 1.0\n" + row +
          "limits_db = [-1, 0.5]\nrelative_to_hz = 40\nchannel = \"d/x\"\n" +
          "from_level_m_s2 = 2\nto_level_m_s2 = 15\n" + row +
          "limits_deg = 2.5\nnominal_deg = 180\nnominal_delay_s = 8.1e-3\n",
      "t.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->specification, "data sheet");
  EXPECT_EQ(read->rule, analysis::DecisionRule::guard_band);
  EXPECT_EQ(read->guard_factor, 0.83);
  ASSERT_EQ(read->rows.size(), 3U);
  const ToleranceRow& percent = read->rows[0];
  EXPECT_EQ(percent.unit, ToleranceUnit::percent);
  EXPECT_EQ(percent.lower, -5.0);
  EXPECT_EQ(percent.upper, 5.0);
  EXPECT_EQ(percent.from_hz, 10.0);
  EXPECT_EQ(percent.to_hz, 63.0);
  EXPECT_EQ(percent.nominal, 1.0);
  EXPECT_FALSE(percent.from_level_m_s2);
  const ToleranceRow& decibel = read->rows[1];
  EXPECT_EQ(decibel.unit, ToleranceUnit::decibel);
  EXPECT_EQ(decibel.lower, -1.0);
  EXPECT_EQ(decibel.relative_to_hz, 40.0);
  EXPECT_EQ(decibel.channel, "d/x");
  EXPECT_EQ(decibel.to_level_m_s2, 15.0);
  const ToleranceRow& degree = read->rows[2];
  EXPECT_TRUE(degree.is_of_phase());
  EXPECT_EQ(degree.nominal_deg, 180.0);
  EXPECT_EQ(degree.nominal_delay_s, 8.1e-3);
}

TEST(ToleranceTable, RefusesWhatIsNotMeant) {
  struct Case {
    std::string text;
    std::string said;
  };
  const std::array cases{
      Case{"", "'conformity' is missing"},
      Case{rule, "'tolerance' is missing"},
      Case{row + "limits_percent = 5\nnominal = 1.0\n", "'conformity' is missing"},
      Case{"[conformity]\nspecification = \"x\"\n" + row + "limits_percent = 5\nnominal = 1\n",
           "'conformity.rule' is missing"},
      Case{"[conformity]\nrule = \"guard-band\"\n" + row + "limits_percent = 5\nnominal = 1\n",
           "'conformity.specification' is missing"},
      Case{"[conformity]\nspecification = \"x\"\nrule = \"simple-acceptance\"\nguard_factor = 1\n" +
               row + "limits_percent = 5\nnominal = 1\n",
           "belongs to a rule with a guard band"},
      Case{rule + "guard_factor = 0\n" + row + "limits_percent = 5\nnominal = 1\n",
           "must be above 0"},
      Case{rule + row + "limits_percent = 5\n", "'tolerance.nominal' is missing"},
      Case{rule + row + "nominal = 1\n", "limits_percent' is missing"},
      Case{rule + row + "limits_percent = 5\nlimits_db = 1\nnominal = 1\n",
           "stands beside 'limits_percent'"},
      Case{rule + row + "limits_percent = -5\nnominal = 1\n", "one number above 0"},
      Case{rule + row + "limits_percent = [5, 5]\nnominal = 1\n", "one number above 0"},
      Case{rule + row + "limits_percent = [1, 2, 3]\nnominal = 1\n", "one number above 0"},
      Case{rule + row + "limits_deg = 190\n", "within -180 and 180"},
      Case{rule + row + "limits_deg = 2\nnominal = 1\n", "belongs to a magnitude"},
      Case{rule + row + "limits_percent = 5\nnominal = 1\nrelative_to_hz = 80\n",
           "belongs to a magnitude without relative_to_hz"},
      Case{rule + row + "limits_percent = 5\nnominal = 1\nnominal_deg = 1\n",
           "belongs to limits_deg"},
      Case{rule + row + "limits_percent = 5\nnominal = 0\n", "must be above 0"},
      Case{rule + "[[tolerance]]\nfrom_hz = 63\nto_hz = 10\nlimits_percent = 5\nnominal = 1\n",
           "is below from_hz"},
      Case{rule + "[[tolerance]]\nto_hz = 10\nlimits_percent = 5\nnominal = 1\n",
           "'tolerance.from_hz' is missing"},
      Case{rule + row + "limits_percent = 5\nnominal = 1\nlimit = 3\n", "is not known"},
      Case{rule + row +
               "limits_percent = 5\nnominal = 1\nfrom_level_m_s2 = 3\n"
               "to_level_m_s2 = 2\n",
           "is below from_level_m_s2"},
      Case{rule + "tolerance = 5\n", "is not known"},
      Case{"tolerance = 5\n" + rule, "must be a list of tables"}};
  for (const Case& one : cases) {
    const auto read = parse_tolerance_file(one.text, "t.toml");
    ASSERT_FALSE(read) << one.text;
    EXPECT_THAT(read.error().message, HasSubstr(one.said)) << one.text;
    EXPECT_THAT(read.error().message, HasSubstr("t.toml:")) << one.text;
  }
}

TEST(ToleranceTable, MayStandInTheSensorFile) {
  const std::string sensor = "[sensor]\nname = \"a\"\nmanufacturer = \"b\"\nmodel = \"c\"\n"
                             "serial = \"d\"\n";
  const auto with =
      parse_sensor_file(sensor + rule + row + "limits_percent = 5\nnominal = 1\n", "s.toml");
  ASSERT_TRUE(with) << with.error().message;
  ASSERT_TRUE(with->tolerances);
  EXPECT_EQ(with->tolerances->rows.size(), 1U);
  const auto without = parse_sensor_file(sensor, "s.toml");
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_FALSE(without->tolerances);
}

} // namespace
} // namespace dyncal::inline views
