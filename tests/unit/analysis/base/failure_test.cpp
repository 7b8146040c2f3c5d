#include "analysis/base/failure.hpp"

#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace dyncal {
namespace {

enum class Code { refused, unreadable };
using Error = Failure<Code>;
template <class T>
using Expected = tl::expected<T, Error>;

// Counts how often it was copied since it was made; moves are free.
struct Counted {
  explicit Counted(int& counter) : copies(&counter) {}
  Counted(const Counted& other) : copies(other.copies) { ++*copies; }
  Counted(Counted&&) = default;
  Counted& operator=(const Counted&) = delete;
  Counted& operator=(Counted&&) = default;
  ~Counted() = default;

  int* copies;
};

Expected<int> number(bool ok) {
  return ok ? Expected<int>(7) : fail(Code::refused, "no number: ask again");
}

Expected<void> check(bool ok) {
  return ok ? Expected<void>() : fail(Code::unreadable, "line 3: not a rate");
}

TEST(Try, DeclaresTheValue) {
  const auto sum = []() -> Expected<int> {
    DYNCAL_TRY(const auto first, number(true));
    DYNCAL_TRY(auto second, number(true));
    static_assert(std::is_same_v<decltype(first), const int>);
    second += 1;
    return first + second;
  };
  EXPECT_EQ(sum(), 15);
}

TEST(Try, ReturnsTheErrorAsItIsAndDoesNothingMore) {
  bool went_on = false;
  const auto text = [&]() -> Expected<std::string> {
    DYNCAL_TRY(const auto value, number(false));
    went_on = true;
    return std::to_string(value);
  };
  const auto refused = text();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::refused);
  EXPECT_EQ(refused.error().message, "no number: ask again");
  EXPECT_FALSE(went_on);
}

TEST(Try, TakesCallsWithoutAValue) {
  int steps = 0;
  const auto both = [&steps](bool first, bool second) -> Expected<int> {
    DYNCAL_TRY(check(first));
    ++steps;
    DYNCAL_TRY(check(second));
    return ++steps;
  };
  EXPECT_EQ(both(true, true), 2);
  const auto refused = both(true, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::unreadable);
  EXPECT_EQ(steps, 3);
  EXPECT_FALSE(both(false, true));
  EXPECT_EQ(steps, 3);
}

TEST(Try, DropsAValueThatIsNotNeeded) {
  const auto checked = [](bool ok) -> Expected<std::string> {
    DYNCAL_TRY(number(ok));
    return "7 is one";
  };
  EXPECT_EQ(checked(true), "7 is one");
  ASSERT_FALSE(checked(false));
  EXPECT_EQ(checked(false).error().code, Code::refused);
}

TEST(Try, AssignsTheValueAndLeavesTheOldOneWhereThereIsAnError) {
  struct {
    int rate_hz = 1;
  } settings;
  const auto set = [&settings](bool ok) -> Expected<void> {
    DYNCAL_TRY(settings.rate_hz, number(ok));
    return {};
  };
  EXPECT_FALSE(set(false));
  EXPECT_EQ(settings.rate_hz, 1);
  EXPECT_TRUE(set(true));
  EXPECT_EQ(settings.rate_hz, 7);
}

TEST(Try, MovesTheValue) {
  const auto owned = []() -> Expected<std::unique_ptr<int>> {
    DYNCAL_TRY(auto made, Expected<std::unique_ptr<int>>(std::make_unique<int>(3)));
    return made;
  };
  const auto made = owned();
  ASSERT_TRUE(made);
  EXPECT_EQ(**made, 3);

  int copies = 0;
  const auto kept = [&copies]() -> Expected<std::vector<Counted>> {
    std::vector<Counted> all;
    DYNCAL_TRY(auto one, Expected<Counted>(Counted(copies)));
    all.push_back(std::move(one));
    return all;
  };
  EXPECT_TRUE(kept());
  EXPECT_EQ(copies, 0);
}

TEST(Try, LeavesAnOutcomeThatHasANameAsItWas) {
  int copies = 0;
  const auto use = [](const Expected<Counted>& outcome) -> Expected<const int*> {
    DYNCAL_TRY(outcome);
    DYNCAL_TRY(const auto& counted, outcome);
    return &*outcome == &counted ? counted.copies : nullptr;
  };
  const Expected<Counted> outcome{Counted(copies)};
  EXPECT_EQ(use(outcome), &copies);
  EXPECT_EQ(copies, 0);

  const Expected<Counted> failed = fail(Code::refused, std::string(100, 'x'));
  EXPECT_FALSE(use(failed));
  EXPECT_EQ(failed.error().message, std::string(100, 'x'));
}

TEST(Try, DeclaresAReferenceToWhatACallReturnsByReference) {
  Expected<std::string> kept = std::string("kept");
  const auto cached = [&kept]() -> Expected<std::string>& { return kept; };
  const auto append = [&]() -> Expected<void> {
    DYNCAL_TRY(auto& text, cached());
    text += " and changed";
    return {};
  };
  EXPECT_TRUE(append());
  EXPECT_EQ(kept, "kept and changed");
}

TEST(Try, TakesACommaOutsideParentheses) {
  using Names = std::map<int, std::string>;
  const auto size = []() -> Expected<std::size_t> {
    DYNCAL_TRY(const auto names, Expected<std::map<int, std::string>>(Names{{1, "a"}, {2, "b"}}));
    return names.size();
  };
  EXPECT_EQ(size(), 2U);
}

TEST(Try, WorksInLoopsAndInLambdasThatDoNotNameTheirType) {
  const auto errors_only = [](bool ok) {
    for (int i = 0; i < 3; ++i) {
      DYNCAL_TRY(const auto value, number(ok || i < 2));
      if (value != 7) {
        return fail(Code::unreadable, "not 7");
      }
    }
    return fail(Code::unreadable, "all three were there");
  };
  EXPECT_EQ(errors_only(true).value().message, "all three were there");
  EXPECT_EQ(errors_only(false).value().message, "no number: ask again");
}

} // namespace
} // namespace dyncal
