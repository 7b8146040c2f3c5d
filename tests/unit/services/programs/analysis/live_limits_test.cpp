#include "services/programs/analysis/live_limits.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

Recipe recipe_of(std::size_t steps, std::uint64_t trials) {
  Recipe recipe;
  const auto frequency = analysis::Frequency::from_hz(80.0);
  recipe.steps.assign(steps, RecipeStep{.frequency_text_hz = "80", .frequency = frequency});
  recipe.monte_carlo_trials = trials;
  return recipe;
}

TEST(LiveLimits, TheEndOfAShortRunIsNotMadeElsewhere) {
  const EvaluationLimits limits = live_limits(recipe_of(20, 5000));
  EXPECT_TRUE(limits.ahead);
  EXPECT_FALSE(limits.never_waits);
}

TEST(LiveLimits, SamplesDoNotWaitForTheEndOfALongRun) {
  const EvaluationLimits limits = live_limits(recipe_of(21, 0));
  EXPECT_TRUE(limits.ahead); // its steps are quick
  EXPECT_EQ(limits.evaluations_at_once, 0U);
  EXPECT_TRUE(limits.never_waits);
}

TEST(LiveLimits, SamplesDoNotWaitForManyTrials) {
  const EvaluationLimits limits = live_limits(recipe_of(1, 5001));
  EXPECT_FALSE(limits.ahead);
  EXPECT_EQ(limits.evaluations_at_once, 1U);
  EXPECT_TRUE(limits.never_waits);
}

} // namespace
} // namespace dyncal::inline programs
