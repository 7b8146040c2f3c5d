#include "drivers/tables/strict_table.hpp"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "drivers/tables/reference_table.hpp"
#include "tests/unit/drivers/tables/table_examples.hpp"

namespace dyncal::drivers::tables {
namespace {

std::string problem_of(const std::string& from, const std::string& to) {
  std::string text = strict_example;
  text.replace(text.find(from), from.size(), to);
  const auto rows = parse_reference_table("t.csv", text);
  return rows ? "none" : rows.error().message;
}

TEST(StrictTable, ReadsRowsByTheNamesOfTheirColumns) {
  const auto rows = parse_reference_table("t.csv", strict_example);
  ASSERT_TRUE(rows.has_value()) << rows.error().message;
  ASSERT_EQ(rows->size(), 2U);
  const ReferenceTableRow& row = rows->front();
  EXPECT_EQ(row.line, 4U);
  EXPECT_EQ(row.loop, 0);
  EXPECT_EQ(row.frequency_hz, 10.0);
  EXPECT_EQ(row.amplitude_m_s2, 2.739);
  EXPECT_EQ(row.amplitude_deviation_m_s2, 0.000548);
  EXPECT_EQ(row.phase_deg, -43.7679);
  EXPECT_EQ(row.phase_deviation_deg, 0.04);
  EXPECT_FALSE(row.distortion_reference_rel.has_value());
  EXPECT_EQ(rows->back().line, 6U);
  EXPECT_EQ(rows->back().loop, 1);
}

TEST(StrictTable, SaysWhereItIsNotWhatItShouldBe) {
  EXPECT_EQ(problem_of("2.744", "2,744"), "t.csv: line 6, column 3: '2,744'; expected a number "
                                          "with a decimal point for 'ex_amp'");
  EXPECT_EQ(problem_of("2.744", "nan"), "t.csv: line 6, column 3: 'nan'; expected a number with a "
                                        "decimal point for 'ex_amp'");
  EXPECT_EQ(problem_of(";0.05", ""), "t.csv: line 6: 5 cells; expected 6, as line 1 has names");
  EXPECT_EQ(problem_of("m/s^2;m/s^2", "deg/s;m/s^2"),
            "t.csv: line 3, column 3: the unit 'deg/s'; expected m/s^2 (peak)");
  EXPECT_EQ(problem_of("m/s^2;m/s^2", "m/s^2 rms;m/s^2"),
            "t.csv: line 3, column 3: the unit 'm/s^2 rms'; expected m/s^2 (peak)");
  EXPECT_EQ(problem_of("deg;deg", "rad;deg"),
            "t.csv: line 3, column 5: the unit 'rad'; expected deg");
  EXPECT_EQ(problem_of("phase;phase_std", "angle;phase_std"),
            "t.csv: line 1: there are the columns 'loop', 'frequency', 'ex_amp', 'ex_amp_std', "
            "'angle', 'phase_std'; expected one that is named 'phase'");
  EXPECT_EQ(problem_of("1;12.5", "1.5;12.5"),
            "t.csv: line 6, column 1: 1.5; expected a whole number for the loop");
  EXPECT_EQ(problem_of("12.5", "-12.5"), "t.csv: line 6, column 2: -12.5; expected a number above "
                                         "0");
  EXPECT_EQ(problem_of("0.05", "-0.05"),
            "t.csv: line 6, column 6: -0.05; expected a standard deviation of at least 0");
  EXPECT_EQ(problem_of("#Number", "Number"),
            "t.csv: line 3: no units of all columns; expected #Number;Hz;m/s^2;m/s^2;deg;deg");
}

TEST(StrictTable, ReadsTheSharedTable) {
  std::ifstream file(DYNCAL_SHARED_DATA "/reference/acs_reference_table.csv", std::ios::binary);
  if (!file) {
    GTEST_SKIP() << "the shared table reference/acs_reference_table.csv is not there";
  }
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto rows = parse_reference_table("acs_reference_table.csv", text);
  ASSERT_TRUE(rows.has_value()) << rows.error().message;
  ASSERT_EQ(rows->size(), 170U);
  EXPECT_EQ(rows->back().loop, 9);
}

} // namespace
} // namespace dyncal::drivers::tables
