#include "services/evaluation/record/excitation_progress.hpp"

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

class ExcitationProgressTest : public testing::Test {
protected:
  Recipe recipe_ = parse_recipe(tests::SyntheticRun{}.measurement()).value(); // steps 1 and 2
  ExcitationProgress progress_{recipe_};
};

TEST_F(ExcitationProgressTest, TheAnnouncementOfAStepEndsThoseBeforeIt) {
  progress_.announce({.step = 2});
  EXPECT_TRUE(progress_.is_announced_over(0));
  EXPECT_FALSE(progress_.is_announced_over(1));
  progress_.announce({.step = 2, .state = StepAnnouncement::State::done});
  EXPECT_TRUE(progress_.is_announced_over(1));
}

TEST_F(ExcitationProgressTest, AnAbortedRunHasTheStepsThatWereAnnounced) {
  EXPECT_EQ(progress_.steps_expected(), 2U);
  progress_.announce({.step = 1, .state = StepAnnouncement::State::aborted});
  EXPECT_TRUE(progress_.is_broken_off(0));
  progress_.end(true);
  EXPECT_EQ(progress_.steps_expected(), 1U);
}

TEST_F(ExcitationProgressTest, AStepThatTheRecipeDoesNotHaveChangesNothing) {
  progress_.announce({.step = 99, .state = StepAnnouncement::State::aborted});
  progress_.end(true);
  EXPECT_EQ(progress_.steps_expected(), 0U);
}

} // namespace
} // namespace dyncal::inline evaluation
