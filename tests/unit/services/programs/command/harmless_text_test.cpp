#include "services/programs/command/harmless_text.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

TEST(HarmlessText, KeepsWhatIsReadable) {
  EXPECT_EQ(harmless("acc-1, 20 °C, µs"), "acc-1, 20 °C, µs");
  EXPECT_EQ(columns_of("20 °C"), 5U);
}

TEST(HarmlessText, ReplacesWhatMovesTheCursorOrIsWider) {
  EXPECT_EQ(harmless("a\x1b[2Jb\r\n\tc"), "a?[2Jb???c");
  EXPECT_EQ(harmless("\xc2\x9b"
                     "31m"),
            "?31m");                                     // C1 control
  EXPECT_EQ(harmless("\xe6\xb8\xac\xe5\xae\x9a"), "??"); // two columns each
  EXPECT_EQ(harmless("e\xcc\x81"), "e?");                // combining
  EXPECT_EQ(harmless("\xff\xc3"), "??");                 // not UTF-8
}

TEST(HarmlessText, InColumns) {
  EXPECT_EQ(in_columns("abc", 5), "abc  ");
  EXPECT_EQ(in_columns("abcdef", 5), "abc..");
  EXPECT_EQ(in_columns("°°°°°°", 5), "°°°..");
  EXPECT_EQ(in_columns("abc", 1), ".");
}

TEST(HarmlessText, OfA100KilobytesIsOneShortLine) {
  const std::string shown = harmless(std::string(100'000, '\n') + "\x1b[2J");
  EXPECT_LE(shown.size(), 1000U);
  EXPECT_EQ(shown.find_first_of("\n\x1b"), std::string::npos);
}

} // namespace
} // namespace dyncal::inline programs
