#include "services/evaluation/record/step_snapshot.hpp"

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

// The records of a run up to some time before the end of its first step is found, which both
// sources expect by then.
class StepSnapshotTest : public testing::Test {
protected:
  static constexpr double expected_at_s = 1.95;

  StepSnapshotTest()
      : recipe_(*parse_recipe(run_.measurement())),
        records_(recipe_, {{{"acs", "sync"}, {"acs"}}, {{"dau", "sync"}, {"dau"}}}) {
    records_.find("acs")->describe(contract::from_message(run_.acs_description()));
    records_.find("dau")->describe(contract::from_message(run_.dau_description()));
    add_until(expected_at_s);
  }

  void add_until(double t_s) {
    const auto ns = static_cast<std::int64_t>(t_s * 1e9);
    for (; acs_ < acs_blocks_.size() && first_ns(acs_blocks_[acs_]) < ns; ++acs_) {
      tests::feed(*records_.find("acs"), acs_blocks_[acs_]);
    }
    for (; dau_ < dau_blocks_.size() && first_ns(dau_blocks_[dau_]) < ns; ++dau_) {
      tests::feed(*records_.find("dau"), dau_blocks_[dau_]);
    }
    records_.search();
  }
  // Since the beginning of the run.
  std::int64_t first_ns(const wire::SampleBlock& block) const {
    const std::int64_t stamp_ns = view_block(block).first_stamp_ns();
    return block.stamps_ns().empty() ? stamp_ns
                                     : stamp_ns - dau_blocks_.front().stamps_ns().front();
  }

  tests::SyntheticRun run_;
  Recipe recipe_;
  RunRecords records_;
  std::vector<wire::SampleBlock> acs_blocks_ = run_.acs_blocks();
  std::vector<wire::SampleBlock> dau_blocks_ = run_.dau_blocks();
  std::size_t acs_ = 0;
  std::size_t dau_ = 0;
};

TEST_F(StepSnapshotTest, HoldsAsLongAsOnlyLaterSamplesCome) {
  ASSERT_TRUE(records_.is_expected(0));
  ASSERT_FALSE(records_.is_searched(0));
  StepSnapshot snapshot(records_, 0);
  EXPECT_EQ(snapshot.step(), 0U);
  EXPECT_TRUE(snapshot.still_holds(records_));
  const auto expected = records_.interval(1, 0);
  add_until(2.6);
  ASSERT_TRUE(records_.is_searched(0));
  EXPECT_EQ(records_.interval(1, 0), expected);
  EXPECT_TRUE(snapshot.still_holds(records_));
}

TEST_F(StepSnapshotTest, AStepIsNotExpectedBeforeItsPlannedSamplesHaveCome) {
  RunRecords records(recipe_, {{{"acs", "sync"}, {"acs"}}});
  records.find("acs")->describe(contract::from_message(run_.acs_description()));
  for (const wire::SampleBlock& block : acs_blocks_) {
    if (first_ns(block) > 1'400'000'000) { // 0.5 s off, 0.2 s settling, 0.8 s planned
      break;
    }
    tests::feed(*records.find("acs"), block);
    records.search();
    EXPECT_FALSE(records.is_expected(0));
  }
}

TEST_F(StepSnapshotTest, DoesNotHoldWhenAClockStepsBackIntoTheStep) {
  StepSnapshot snapshot(records_, 0);
  wire::SampleBlock& block = dau_blocks_[dau_];
  block.stamps_ns().back() = records_.interval(1, 0)->end_ns - 1;
  add_until(2.0);
  EXPECT_FALSE(snapshot.still_holds(records_));
}

TEST_F(StepSnapshotTest, DoesNotHoldWhenASourceWasRestarted) {
  StepSnapshot snapshot(records_, 0);
  for (std::size_t i = dau_; i < dau_blocks_.size(); ++i) {
    dau_blocks_[i].session(8);
  }
  add_until(2.0);
  EXPECT_FALSE(snapshot.still_holds(records_));
}

TEST_F(StepSnapshotTest, DoesNotHoldWhenTheExcitationWasBrokenOff) {
  StepSnapshot snapshot(records_, 0);
  records_.excitation().announce({.step = 1, .state = StepAnnouncement::State::aborted});
  EXPECT_FALSE(snapshot.still_holds(records_));
}

} // namespace
} // namespace dyncal::inline evaluation
