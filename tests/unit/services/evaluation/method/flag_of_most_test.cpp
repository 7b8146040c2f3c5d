#include "services/evaluation/method/flag_of_most.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr ResultFlag kind = ResultFlag::changed_within_step;

StepResult result_of(const std::string& channel, bool flagged, bool valid = true) {
  StepResult result;
  result.channel = channel;
  result.valid = valid;
  if (flagged) {
    result.flags.push_back({kind, "as found"});
  }
  return result;
}

std::size_t flags_of(const std::vector<StepResult>& results) {
  std::size_t count = 0;
  for (const StepResult& result : results) {
    count += result.flags.size();
  }
  return count;
}

TEST(FlagOfMost, IsGivenToTheOtherStepsOfTheChannel) {
  std::vector<StepResult> results{result_of("dau/x", true), result_of("dau/x", true),
                                  result_of("dau/x", false), result_of("dau/y", false)};
  EXPECT_TRUE(add_flag_of_most(kind, results));
  ASSERT_EQ(results[2].flags.size(), 1U);
  EXPECT_EQ(results[2].flags[0].kind, kind);
  EXPECT_EQ(results[2].flags[0].sentence,
            "dau/x: changed within the step: so it is in 2 of 3 steps; "
            "here noise or a low frequency hides it");
  EXPECT_TRUE(results[3].flags.empty());
  EXPECT_FALSE(add_flag_of_most(kind, results)); // all have it
  EXPECT_EQ(flags_of(results), 3U);
}

TEST(FlagOfMost, IsGivenFromHalfOfTheStepsOn) {
  std::vector<StepResult> results{result_of("dau/x", true), result_of("dau/x", false),
                                  result_of("dau/x", true), result_of("dau/x", false)};
  EXPECT_TRUE(add_flag_of_most(kind, results));
  EXPECT_EQ(flags_of(results), 4U);
}

TEST(FlagOfMost, OneAloneMayBeChance) {
  std::vector<StepResult> results{result_of("dau/x", true), result_of("dau/x", false)};
  EXPECT_FALSE(add_flag_of_most(kind, results));
  EXPECT_EQ(flags_of(results), 1U);
}

TEST(FlagOfMost, StepsWithoutAValueNeitherCountNorGetIt) {
  std::vector<StepResult> results{result_of("dau/x", true), result_of("dau/x", false, false),
                                  result_of("dau/x", true, false)};
  EXPECT_FALSE(add_flag_of_most(kind, results));
  EXPECT_EQ(flags_of(results), 2U);
}

} // namespace
} // namespace dyncal::inline evaluation
