#include "services/evaluation/result/result_flag.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using testing::ElementsAre;

std::vector<ResultFlag> all_flags() {
  std::vector<ResultFlag> flags;
  for (int i = 0; i <= static_cast<int>(ResultFlag::from_message); ++i) {
    flags.push_back(static_cast<ResultFlag>(i));
  }
  return flags;
}

TEST(ResultFlag, EveryFlagHasANameOfItsOwnAndAnExplanation) {
  std::set<std::string_view> names;
  for (const ResultFlag flag : all_flags()) {
    const std::string_view name = name_of(flag);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(parse_flag_name(name), flag);
    EXPECT_TRUE(std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::islower(c) != 0 || c == '_';
    })) << name;
    EXPECT_GT(explanation_of(flag).size(), 40U) << name;
    EXPECT_NE(explanation_of(flag).find(';'), std::string_view::npos)
        << name << ": what it means; what to do";
    EXPECT_NE(explanation_of(flag).back(), '.') << name;
  }
  EXPECT_EQ(names.size(), all_flags().size());
  EXPECT_GE(names.size(), 21U);
}

TEST(ResultFlag, IsReadBackFromAMessageByItsName) {
  const std::vector<Flag> flags{flag_of_source(ResultFlag::samples_lost, "dau"),
                                make_flag(ResultFlag::polarity_inverted)};
  EXPECT_THAT(names_of(flags), ElementsAre("samples_lost", "polarity_inverted"));
  EXPECT_EQ(flags_from_message(sentences_of(flags), names_of(flags)), flags);
}

TEST(ResultFlag, OfAnotherVersionKeepsItsSentence) {
  const auto flags = flags_from_message({"dau: on fire", "dau: samples lost"}, {"on_fire"});
  ASSERT_EQ(flags.size(), 2U);
  EXPECT_EQ(flags[0], (Flag{ResultFlag::from_message, "dau: on fire"}));
  EXPECT_EQ(flags[1].kind, ResultFlag::from_message); // its writer sent no name
}

} // namespace
} // namespace dyncal::inline evaluation
