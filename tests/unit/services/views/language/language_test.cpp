#include "services/views/language/language.hpp"

#include <gmock/gmock.h>

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Languages, AreReadInTheirOrder) {
  EXPECT_THAT(*parse_languages("de"), ElementsAre(Language::german));
  EXPECT_THAT(*parse_languages("de,en"), ElementsAre(Language::german, Language::english));
}

TEST(Languages, ThatAreNotKnownOrComeTwiceAreRefused) {
  for (const char* const codes : {"", "fr", "de,", ",", "de,de", "DE", "de en"}) {
    const auto languages = parse_languages(codes);
    ASSERT_FALSE(languages) << codes;
    EXPECT_THAT(languages.error().message, HasSubstr("\"de,en\""));
  }
}

TEST(Languages, HaveADecimalMarkOfTheirOwn) {
  EXPECT_EQ(decimal(Language::english, std::string("1.5")), "1.5");
  EXPECT_EQ(decimal(Language::german, std::string("-1.5e-07")), "-1,5e-07");
}

TEST(Languages, WriteDaysTheirOwnWay) {
  EXPECT_EQ(day_text(Language::english, "2026-03-01"), "2026-03-01");
  EXPECT_EQ(day_text(Language::german, "2026-03-01"), "01.03.2026");
  EXPECT_EQ(day_text(Language::german, "spring 2026"), "spring 2026");
  EXPECT_EQ(instant_text(Language::english, "2026-03-01T12:00:05.5Z"), "2026-03-01 12:00:05 UTC");
  EXPECT_EQ(instant_text(Language::german, "2026-03-01T12:00:05.5Z"), "01.03.2026 12:00:05 UTC");
  EXPECT_EQ(instant_text(Language::german, ""), "");
}

TEST(Sentence, IsFilledInInEachLanguage) {
  static constexpr Sentence replaces{"replaces {}", "ersetzt {}"};
  EXPECT_EQ(replaces(Language::english, 1), "replaces 1");
  EXPECT_EQ(replaces(Language::german, 1), "ersetzt 1");
  const auto text = in_all_languages([](Language language) { return replaces(language, "x"); });
  EXPECT_EQ(text.english, "replaces x");
  EXPECT_EQ(text.in(Language::german), "ersetzt x");
}

} // namespace
} // namespace dyncal::inline views
