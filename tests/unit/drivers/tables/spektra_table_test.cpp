#include "drivers/tables/spektra_table.hpp"

#include <gtest/gtest.h>

#include "drivers/tables/reference_table.hpp"
#include "tests/unit/drivers/tables/table_examples.hpp"

namespace dyncal::drivers::tables {
namespace {

std::string problem_of(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  const auto rows = parse_reference_table("s", text);
  return rows ? "none" : rows.error().message;
}

TEST(SpektraTable, NeverTakesTheScatterOfSForUOfTheAmplitude) {
  for (const std::string& text : {spektra_csv_example, spektra_prp_example}) {
    const auto rows = parse_reference_table("s", text);
    ASSERT_TRUE(rows.has_value()) << rows.error().message;
    ASSERT_EQ(rows->size(), 2U);
    for (const ReferenceTableRow& row : *rows) {
      EXPECT_FALSE(row.amplitude_deviation_m_s2.has_value());
    }
  }
}

TEST(SpektraTable, ReadsCsv) {
  const auto rows = parse_reference_table("s.csv", spektra_csv_example);
  ASSERT_TRUE(rows.has_value()) << rows.error().message;
  ASSERT_EQ(rows->size(), 2U);
  const ReferenceTableRow& row = rows->back();
  EXPECT_EQ(row.line, 4U);
  EXPECT_FALSE(row.loop.has_value());
  EXPECT_EQ(row.frequency_hz, 250.0);
  EXPECT_EQ(row.amplitude_m_s2, 100.1);
  EXPECT_EQ(row.phase_deg, -77.25);
  EXPECT_EQ(row.phase_deviation_deg, 0.1);
  EXPECT_DOUBLE_EQ(*row.distortion_reference_rel, 0.005);
  EXPECT_DOUBLE_EQ(*row.distortion_sync_rel, 0.007);
}

TEST(SpektraTable, ReadsPrpWithItsDecimalComma) {
  const auto rows = parse_reference_table("prp.txt", spektra_prp_example);
  ASSERT_TRUE(rows.has_value()) << rows.error().message;
  ASSERT_EQ(rows->size(), 2U);
  EXPECT_EQ(rows->front().line, 20U);
  EXPECT_EQ(rows->front().frequency_hz, 10.0);
  EXPECT_EQ(rows->front().amplitude_m_s2, 2.739);
  EXPECT_EQ(rows->front().phase_deg, -43.7679);
  EXPECT_FALSE(rows->front().phase_deviation_deg.has_value());
}

TEST(SpektraTable, SaysWhereItIsNotWhatItShouldBe) {
  EXPECT_EQ(problem_of(spektra_prp_example, "2,744", "2.744"),
            "s: line 21, column 2: '2.744'; expected a number with a decimal comma for 'Accel.,'");
  EXPECT_EQ(problem_of(spektra_prp_example, "2,744", "(Ref. value)"),
            "s: line 21, column 2: '(Ref. value)'; expected a number with a decimal comma for "
            "'Accel.,'");
  EXPECT_EQ(problem_of(spektra_csv_example, ";m/s2;", ";g;"),
            "s: line 2, column 3: the unit 'g'; expected m/s^2 (peak)");
  EXPECT_EQ(problem_of(spektra_csv_example, "deg;deg;%", "rad;deg;%"),
            "s: line 2, column 7: the unit 'rad'; expected deg");
  EXPECT_EQ(problem_of(spektra_csv_example, "250;100.1;12.30;", "250;100.1;"),
            "s: line 4: 11 cells; expected 12, one for every name");
  EXPECT_EQ(problem_of(spektra_csv_example, "-77.25;0.1", "-77.25;-0.1"),
            "s: line 4, column 8: -0.1; expected a number of at least 0");
}

} // namespace
} // namespace dyncal::drivers::tables
