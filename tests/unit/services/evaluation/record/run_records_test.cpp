#include "services/evaluation/record/run_records.hpp"

#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr std::int64_t s_ns = 1'000'000'000;

class RunRecordsTest : public testing::Test {
protected:
  // One sample of the ACS, whatever its host's clock shows.
  void add(std::int64_t stamp_ns, const std::optional<BlockTimes>& times = {}) {
    stamps_ = {stamp_ns};
    SourceBlock block;
    block.session = session_;
    block.number = number_++;
    block.first_sample = sample_++;
    block.samples = 1;
    block.channels = 1;
    block.stamps_ns = stamps_;
    block.values = value_;
    if (times) {
      records_.note_times("acs", block, *times);
    }
    ASSERT_TRUE(records_.find("acs")->add(block));
    records_.search();
  }
  void restart() {
    ++session_;
    number_ = 0;
    sample_ = 0;
  }

  Recipe recipe_ = parse_recipe(tests::SyntheticRun{}.measurement()).value(); // steps 1 and 2
  RunRecords records_{recipe_, {}};
  std::vector<std::int64_t> stamps_;
  std::vector<double> value_{0.0};
  std::uint64_t session_ = 1;
  std::uint64_t number_ = 0;
  std::uint64_t sample_ = 0;
};

TEST_F(RunRecordsTest, AStepIsOverInASourceThatHasGoneOnSinceItWasAnnouncedSo) {
  add(10 * s_ns);
  EXPECT_FALSE(records_.is_over_in("acs", 0));
  records_.announce({.step = 1, .state = StepAnnouncement::State::done});
  add(15 * s_ns);
  EXPECT_FALSE(records_.is_over_in("acs", 0));
  add(15 * s_ns + 1);
  EXPECT_TRUE(records_.is_over_in("acs", 0));
  EXPECT_FALSE(records_.is_over_in("acs", 1));
  EXPECT_FALSE(records_.is_over_in("dau", 0)); // has sent nothing
}

TEST_F(RunRecordsTest, ASourceThatBeginsLateGoesOnFromItsFirstSample) {
  records_.announce({.step = 1, .state = StepAnnouncement::State::done});
  add(100 * s_ns);
  EXPECT_FALSE(records_.is_over_in("acs", 0));
  add(105 * s_ns + 1);
  EXPECT_TRUE(records_.is_over_in("acs", 0));
}

TEST_F(RunRecordsTest, ASourceWhoseClockBeginsAnewGoesOnFromThere) {
  add(1000 * s_ns);
  records_.announce({.step = 1, .state = StepAnnouncement::State::done});
  restart();
  add(1 * s_ns);
  EXPECT_FALSE(records_.is_over_in("acs", 0));
  add(6 * s_ns + 1);
  EXPECT_TRUE(records_.is_over_in("acs", 0));
}

// Its host sends in time, and the network brings it late.
TEST_F(RunRecordsTest, ASourceThatIsHeardLateGoesOnFromWhenTheStepWasOver) {
  add(1 * s_ns, BlockTimes{1 * s_ns, 1 * s_ns});
  add(4 * s_ns, BlockTimes{4 * s_ns, 12 * s_ns});
  records_.announce({.step = 1, .state = StepAnnouncement::State::done}, 12 * s_ns);
  for (std::int64_t sent_s = 5; sent_s <= 17; ++sent_s) {
    add(sent_s * s_ns, BlockTimes{sent_s * s_ns, (sent_s + 8) * s_ns});
    EXPECT_FALSE(records_.is_over_in("acs", 0)) << sent_s;
  }
  add(18 * s_ns, BlockTimes{18 * s_ns, 26 * s_ns});
  EXPECT_TRUE(records_.is_over_in("acs", 0));
}

// Its service was stopped: what the instrument had measured meanwhile comes all at once.
TEST_F(RunRecordsTest, ASourceThatWasStoppedIsWaitedFor) {
  constexpr std::int64_t ms_ns = 1'000'000;
  add(1 * s_ns, BlockTimes{1 * s_ns, 1 * s_ns});
  records_.announce({.step = 1, .state = StepAnnouncement::State::done}, 12 * s_ns);
  std::int64_t heard_ns = 13 * s_ns;
  for (std::int64_t stamp_s = 2; stamp_s <= 30; ++stamp_s, heard_ns += 30 * ms_ns) {
    add(stamp_s * s_ns, BlockTimes{heard_ns, heard_ns});
    EXPECT_FALSE(records_.is_over_in("acs", 0)) << stamp_s;
  }
  add(31 * s_ns, BlockTimes{17 * s_ns, 17 * s_ns});
  EXPECT_TRUE(records_.is_over_in("acs", 0));
}

// By an hour: what was sent since seems to be sent before the announcement.
TEST_F(RunRecordsTest, ASourceWhoseHostsClockWasSetBackIsNotWaitedForLongerThanAMinute) {
  add(10 * s_ns, BlockTimes{5000 * s_ns, 10 * s_ns});
  records_.announce({.step = 1, .state = StepAnnouncement::State::done}, 11 * s_ns);
  for (std::int64_t stamp_s = 11; stamp_s <= 75; ++stamp_s) {
    add(stamp_s * s_ns, BlockTimes{(1400 + stamp_s) * s_ns, stamp_s * s_ns});
    EXPECT_FALSE(records_.is_over_in("acs", 0)) << stamp_s;
  }
  add(76 * s_ns, BlockTimes{1476 * s_ns, 76 * s_ns});
  EXPECT_TRUE(records_.is_over_in("acs", 0));
}

TEST_F(RunRecordsTest, NothingComesAnyMoreOnceTheRunIsCutShort) {
  EXPECT_FALSE(records_.is_over_in("acs", 1));
  records_.excitation().cut_short();
  EXPECT_TRUE(records_.is_over_in("acs", 1));
}

} // namespace
} // namespace dyncal::inline evaluation
