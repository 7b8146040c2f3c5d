#include "services/views/language/flag_text.hpp"

#include <set>

#include <gtest/gtest.h>

#include "services/base/per_enumerator.hpp"
#include "services/views/language/closure_text.hpp"

namespace dyncal::inline views {
namespace {

TEST(FlagText, EveryFlagHasAGermanMeaningOfItsOwn) {
  std::set<std::string_view> meanings;
  constexpr auto count = number_of_enumerators<ResultFlag>();
  for (std::size_t place = 0; place < count; ++place) {
    const auto meaning = german_meaning_of(static_cast<ResultFlag>(place));
    EXPECT_TRUE(meaning.ends_with(".")) << place;
    meanings.insert(meaning);
  }
  EXPECT_EQ(meanings.size(), count);
  EXPECT_GT(count, 30U);
}

TEST(ClosureText, EveryClosureHasATitleInBothLanguages) {
  std::set<std::string_view> titles;
  constexpr auto count = number_of_enumerators<ClosureKind>();
  for (std::size_t place = 0; place < count; ++place) {
    titles.insert(closure_title(static_cast<ClosureKind>(place), Language::english));
    titles.insert(closure_title(static_cast<ClosureKind>(place), Language::german));
  }
  EXPECT_EQ(titles.size(), 2 * count);
  EXPECT_EQ(verdict_text(Verdict::open, Language::german), "stimmt nicht");
}

} // namespace
} // namespace dyncal::inline views
