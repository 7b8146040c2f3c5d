#include "services/evaluation/record/excitation_progress.hpp"

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::services {
namespace {

class ExcitationProgressTest : public testing::Test {
protected:
  static SourceRecord source_at(std::int64_t received_utc_ns) {
    SourceRecord record("acs");
    SourceBlock block; // without samples
    block.received_utc_ns = received_utc_ns;
    record.add(block);
    return record;
  }

  Recipe recipe_ = parse_recipe(tests::SyntheticRun{}.measurement()).value(); // steps 1 and 2
  ExcitationProgress progress_{recipe_};
};

TEST_F(ExcitationProgressTest, AStepIsOverTwoSecondsAfterItWasAnnouncedSo) {
  progress_.announce(
      {.step = 1, .state = StepAnnouncement::State::done, .window_end_utc_ns = 10'000'000'000});
  EXPECT_TRUE(progress_.is_announced_over(0));
  EXPECT_FALSE(progress_.is_over_in(source_at(12'000'000'000), 0));
  EXPECT_TRUE(progress_.is_over_in(source_at(12'000'000'001), 0));
  EXPECT_FALSE(progress_.is_over_in(source_at(99'000'000'000), 1));
}

TEST_F(ExcitationProgressTest, TheAnnouncementOfAStepEndsThoseBeforeIt) {
  progress_.announce({.step = 2, .window_begin_utc_ns = 10'000'000'000});
  EXPECT_TRUE(progress_.is_over_in(source_at(13'000'000'000), 0));
  EXPECT_FALSE(progress_.is_announced_over(1));
}

TEST_F(ExcitationProgressTest, AnAbortedRunHasTheStepsThatWereAnnounced) {
  EXPECT_EQ(progress_.steps_expected(), 2U);
  progress_.announce({.step = 1, .state = StepAnnouncement::State::aborted});
  EXPECT_TRUE(progress_.is_broken_off(0));
  progress_.end(true);
  EXPECT_EQ(progress_.steps_expected(), 1U);
}

TEST_F(ExcitationProgressTest, NothingComesAnyMoreOnceItIsCutShort) {
  EXPECT_FALSE(progress_.is_over_in(source_at(0), 1));
  progress_.cut_short();
  EXPECT_TRUE(progress_.is_over_in(source_at(0), 1));
}

TEST_F(ExcitationProgressTest, AStepThatTheRecipeDoesNotHaveChangesNothing) {
  progress_.announce({.step = 99, .state = StepAnnouncement::State::aborted});
  progress_.end(true);
  EXPECT_EQ(progress_.steps_expected(), 0U);
}

} // namespace
} // namespace dyncal::services
