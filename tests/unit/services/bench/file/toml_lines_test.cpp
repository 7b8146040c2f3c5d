#include "services/bench/file/toml_lines.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline bench {
namespace {

TEST(TomlLines, KnowDaysThatThereAre) {
  EXPECT_TRUE(is_date("2028-02-29"));
  for (const char* const text : {"2026-02-29", "2026-13-01", "26-01-01", "2026-1-1", "", "today"}) {
    EXPECT_FALSE(is_date(text)) << text;
  }
}

// A day as people write it is turned; one that could be two days is not guessed.
TEST(TomlLines, SayHowADayIsWritten) {
  EXPECT_EQ(date_rule("1.3.2026"), "must be written as 2026-03-01");
  EXPECT_EQ(date_rule("24. 12. 2025"), "must be written as 2025-12-24");
  for (const char* const text : {"03/04/2026", "31.2.2026", "March 1, 2026", ""}) {
    EXPECT_EQ(date_rule(text), "must be a date, year, month, day: for example 2026-03-01") << text;
  }
}

} // namespace
} // namespace dyncal::inline bench
