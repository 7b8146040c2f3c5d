#include "drivers/tables/table_text.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::tables {
namespace {

TEST(TableText, HasLinesWithAnEndAlone) {
  const TableLines lines = lines_of("a\r\n\nb\nc");
  ASSERT_EQ(lines.lines.size(), 3U);
  EXPECT_EQ(lines.lines[0].text, "a");
  EXPECT_EQ(lines.lines[2].text, "b");
  EXPECT_EQ(lines.lines[2].number, 3U);
  EXPECT_TRUE(lines.cut);
  EXPECT_FALSE(lines_of("a\n  ").cut);
}

TEST(TableText, ComparesNamesByTheirLetters) {
  EXPECT_EQ(letters_of("Std.Dev. Phase"), letters_of("std dev_phase"));
  EXPECT_EQ(letters_of("Accel.,"), "accel");
  const std::string file = "t";
  const TableColumns columns(file, 1, cells_of(" Frequency,; Phase", ';'), '.');
  EXPECT_EQ(*columns.find("frequency"), 0U);
  EXPECT_FALSE(columns.find_if_there("amplitude").has_value());
}

TEST(TableText, QuotesNothingThatATerminalMayTakeAsACommand) {
  const std::string file = "t";
  const TableColumns columns(file, 1, cells_of("a", ';'), '.');
  const auto number = columns.number(2, {"\x1b[2J\xfc"}, 0);
  ASSERT_FALSE(number.has_value());
  EXPECT_EQ(number.error().message,
            "t: line 2, column 1: '?[2J?'; expected a number with a decimal point for 'a'");
}

TEST(TableText, KnowsUnitsInTheirSpellings) {
  const std::string file = "t";
  for (const char* unit : {"m/s^2", "m/s2 Peak", "m/s\xb2", "m/s\xc2\xb2"}) {
    EXPECT_TRUE(require_acceleration({file, 2, 3}, unit).has_value()) << unit;
  }
  for (const char* unit : {"g", "m/s", "m/s^2 rms", "mm/s^2", ""}) {
    EXPECT_FALSE(require_acceleration({file, 2, 3}, unit).has_value()) << unit;
  }
  EXPECT_TRUE(require_degrees({file, 2, 3}, "Degree").has_value());
  EXPECT_FALSE(require_degrees({file, 2, 3}, "rad").has_value());
  EXPECT_FALSE(require_hertz({file, 2, 3}, "kHz").has_value());
}

} // namespace
} // namespace dyncal::drivers::tables
