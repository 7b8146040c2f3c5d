#include "services/bench/file/toml_text.hpp"

#include <string>

#include <gtest/gtest.h>
#include <toml++/toml.h>

namespace dyncal::inline bench {
namespace {

// Why the text is refused; empty: it is not.
std::string refusal(const std::string& text) {
  const auto parsed = parse_toml(text, "bench.toml");
  return parsed ? "" : parsed.error().text();
}

TEST(TomlText, IsATableOfItsKeys) {
  const auto parsed = parse_toml("a = 1\n[b]\nc = \"x\"\n", "bench.toml");
  ASSERT_TRUE(parsed);
  EXPECT_EQ((*parsed)["a"].value<int>(), 1);
  EXPECT_EQ((*parsed)["b"]["c"].value<std::string>(), "x");
}

TEST(TomlText, IsRefusedWithItsLine) {
  EXPECT_EQ(refusal("a = 1\n\nb = = 2\n").rfind("bench.toml:3: not valid TOML: ", 0), 0U);
  const auto failed = parse_toml("a = 1\na = 2\n", "bench.toml");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().file, "bench.toml");
  EXPECT_EQ(failed.error().line, 2U);
}

TEST(TomlText, HasForeignLettersInStringsAndCommentsAlone) {
  for (const char* text : {
           "\xEF\xBB\xBF"
           "a = 1 # Prüfstand",
           "a = \"Prüfstand \\\" ü\"",
           "a = 'Prüfstand \\'",
           "\"Prüfstand\" = 1\r\n'ä' = 2",
           "a = \"\"\"\nü\" \\\"\"\" ü\n\"\"\" # ü",
           "a = '''\nü' '' ü\n''''' # ü",
           "a = ['ü', \"ä\"] # ö\nb = { \"ü\" = 'ä' }",
       }) {
    EXPECT_EQ(refusal(text), "") << text;
  }
  for (const char* text : {
           "a = 1\nPrüfstand = 1",
           "a = 1\n[Prüfstand]",
           "a = 1\n\xCC\xA3",
           "a = '#'\nü = '",
           "a = [{ b = '''x'''', c = 1 },\n{ ü = 1 }]",
           "a = \"\\\"\"\nü = \"",
           "a = \"never closed\nü = 1",
           "# comment\n\xFF",
       }) {
    EXPECT_EQ(refusal(text).rfind("bench.toml:2: not valid TOML: outside of quotation marks", 0),
              0U)
        << text << refusal(text);
  }
}

} // namespace
} // namespace dyncal::inline bench
