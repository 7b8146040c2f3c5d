#include "services/base/per_enumerator.hpp"

#include <gtest/gtest.h>
#include <string>

namespace dyncal::inline base {
namespace {

enum class Fruit { apple, pear, plum };
const char* to_string(Fruit fruit) {
  return per_enumerator(fruit, {"apple", "pear", "plum"});
}

TEST(PerEnumerator, TakesTheEntryOfEachValue) {
  EXPECT_EQ(to_string(Fruit::apple), std::string("apple"));
  EXPECT_EQ(to_string(Fruit::pear), std::string("pear"));
  EXPECT_EQ(to_string(Fruit::plum), std::string("plum"));
}

TEST(PerEnumerator, TextsOfAllValuesAreReadBack) {
  EXPECT_EQ(enumerator_texts<Fruit>(), (std::vector<std::string>{"apple", "pear", "plum"}));
  EXPECT_EQ(parse_enumerator<Fruit>("plum"), Fruit::plum);
  EXPECT_EQ(parse_enumerator<Fruit>("Plum"), std::nullopt);
}

TEST(PerEnumerator, ValueBeyondIsTheOneForOthersElseTheFirst) {
  const auto later = static_cast<Fruit>(3);
  EXPECT_EQ(per_enumerator(later, {1, 2, 3}, 9), 9);
  EXPECT_EQ(per_enumerator(later, {1, 2, 3}), 1);
}

// What it refuses to compile with another number of entries for.
static_assert(is_enumerator<Fruit::plum>() && is_enumerator<static_cast<Fruit>(0)>());
static_assert(!is_enumerator<static_cast<Fruit>(3)>());

} // namespace
} // namespace dyncal::inline base
