#include "services/views/objections/refusing_flags.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

TEST(RefusingFlags, EveryFlagHasAReason) {
  int forbidding = 0;
  for (int i = 0; i <= static_cast<int>(ResultFlag::from_message); ++i) {
    const FlagVerdict verdict = verdict_on(static_cast<ResultFlag>(i));
    EXPECT_GT(verdict.reason.size(), 20U) << i;
    forbidding += verdict.forbids ? 1 : 0;
  }
  EXPECT_EQ(forbidding, 26);
}

TEST(RefusingFlags, ForbidWhatUDoesNotHold) {
  EXPECT_TRUE(verdict_on(ResultFlag::samples_lost).forbids);
  EXPECT_TRUE(verdict_on(ResultFlag::over_range).forbids);
  EXPECT_TRUE(verdict_on(ResultFlag::reference_uncertainty_not_stated).forbids);
  EXPECT_TRUE(verdict_on(ResultFlag::from_message).forbids);
  EXPECT_FALSE(verdict_on(ResultFlag::shots_missing).forbids);
  EXPECT_FALSE(verdict_on(ResultFlag::polarity_inverted).forbids);
}

} // namespace
} // namespace dyncal::inline views
