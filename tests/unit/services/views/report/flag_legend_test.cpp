#include "services/views/report/flag_legend.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FlagLegend, HasEachKindOnceInTheOrderOfTheTable) {
  const auto legend = flag_legend({make_flag(ResultFlag::polarity_inverted),
                                   flag_of_source(ResultFlag::samples_lost, "dau"),
                                   flag_of_source(ResultFlag::samples_lost, "acs"),
                                   flag_of_source(ResultFlag::samples_lost, "dau")});
  ASSERT_EQ(legend.size(), 2U);
  EXPECT_EQ(legend[0].name, "samples_lost");
  EXPECT_THAT(legend[0].sentences, ElementsAre("dau: samples lost", "acs: samples lost"));
  EXPECT_EQ(legend[1].name, "polarity_inverted");
  EXPECT_FALSE(legend[1].meaning.empty());
}

TEST(FlagLegend, ALineDoesNotGrowWithTheRun) {
  std::vector<Flag> flags;
  for (const char* reason : {"a", "b", "c", "d", "e"}) {
    flags.push_back(flag_with_reason(ResultFlag::no_monte_carlo_check, reason));
  }
  EXPECT_THAT(legend_line(flag_legend(flags).front()), HasSubstr("check: c; and 2 more): "));
}

TEST(FlagLegend, AMeanHasTheFlagsOfItsValidRepetitions) {
  RunOutcome outcome = tests::example_outcome();
  const TransferFunction& function = outcome.transfer_functions.front();
  EXPECT_EQ(flag_names(flags_of(outcome, function.channel, function.points[0])), "samples_lost");
  EXPECT_EQ(flag_names(flags_of(outcome, function.channel, function.points[1])), "");
  EXPECT_EQ(flag_names(flags_of(outcome, function)), "polarity_inverted samples_lost");
  outcome.results.front().valid = false;
  EXPECT_EQ(flag_names(flags_of(outcome, function.channel, function.points[0])), "");
  EXPECT_EQ(flag_names(flags_of(outcome)), "samples_lost polarity_inverted");
}

} // namespace
} // namespace dyncal::inline views
