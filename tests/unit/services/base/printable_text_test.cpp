#include "services/base/printable_text.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"

namespace dyncal::inline base {
namespace {

TEST(PrintableText, LeavesUtf8AsItIs) {
  for (const std::string text :
       {"", "dau/acceleration_x", "Brüel & Kjær, 5 µm/s²", "加速度", "𝜑"}) {
    EXPECT_EQ(valid_utf8(text), text);
    EXPECT_EQ(printable(text), text);
  }
}

TEST(PrintableText, ReplacesEveryByteThatIsNotUtf8) {
  EXPECT_EQ(valid_utf8("M\xfcnchen"), "M\xef\xbf\xbdnchen");          // Latin-1
  EXPECT_EQ(valid_utf8("\xc3"), "\xef\xbf\xbd");                      // cut off
  EXPECT_EQ(valid_utf8("\xc0\xaf"), "\xef\xbf\xbd\xef\xbf\xbd");      // '/' in a form too long
  EXPECT_EQ(valid_utf8("\xed\xa0\x80").substr(0, 3), "\xef\xbf\xbd"); // half of a pair of UTF-16
  EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80").size(), 12U);              // beyond U+10FFFF
  EXPECT_EQ(valid_utf8("\xe2\x82z"), "\xef\xbf\xbd\xef\xbf\xbdz");
}

TEST(PrintableText, ShowsNothingThatSteersATerminal) {
  EXPECT_EQ(printable("a\x1b[2Jb\r\nc\x7f"), "a?[2Jb??c?");
  EXPECT_EQ(printable("a\xc2\x9bK"), "a?K"); // U+009B is ESC [
  EXPECT_EQ(printable("\u202eno \u2066\u2069\u2028b\u202a"), "?no ???b?");
  EXPECT_EQ(printable("5\u2027\u202f\u2065\u206a\u2030 \u2212"),
            "5\u2027\u202f\u2065\u206a\u2030 \u2212");
}

TEST(OneLine, LeavesASentenceAsItIs) {
  const std::string sentence(max_line_bytes, 'x');
  EXPECT_EQ(one_line(sentence), sentence);
  EXPECT_EQ(one_line("Brüel & Kjær\n"), "Brüel & Kjær?");
}

TEST(OneLine, KeepsBeginningAndEndOfATextThatIsTooLong) {
  const std::string shown = one_line("who: " + std::string(100'000, '\n') + "; end it there");
  EXPECT_LE(shown.size(), max_line_bytes);
  EXPECT_EQ(shown.substr(0, 8), "who: ???");
  EXPECT_EQ(shown.substr(shown.size() - 17), "???; end it there");
  EXPECT_NE(shown.find(" [...] "), std::string::npos);
}

TEST(OneLine, CutsNoLetter) {
  for (const std::string letter : {"ä", "加", "𝜑", "\xff"}) {
    for (std::size_t ahead = 0; ahead < 4; ++ahead) {
      std::string text(ahead, 'a');
      while (text.size() < 5000) {
        text += letter;
      }
      const std::string shown = one_line(text, 64);
      EXPECT_LE(shown.size(), 64U);
      EXPECT_GE(shown.size(), 50U);
      EXPECT_EQ(valid_utf8(shown), shown);
    }
  }
}

TEST(JsonText, WritesTextsThatAreNotUtf8) {
  const nlohmann::ordered_json json{{"city", "M\xfcnchen"}};
  EXPECT_EQ(json_text(json), "{\"city\":\"M\xef\xbf\xbdnchen\"}");
  EXPECT_TRUE(nlohmann::json::accept(json_text(json, 2)));
}

} // namespace
} // namespace dyncal::inline base
