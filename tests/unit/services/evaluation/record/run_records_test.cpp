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
  void add(std::int64_t stamp_ns) {
    stamps_ = {stamp_ns};
    SourceBlock block;
    block.session = session_;
    block.number = number_++;
    block.first_sample = sample_++;
    block.samples = 1;
    block.channels = 1;
    block.stamps_ns = stamps_;
    block.values = value_;
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

TEST_F(RunRecordsTest, NothingComesAnyMoreOnceTheRunIsCutShort) {
  EXPECT_FALSE(records_.is_over_in("acs", 1));
  records_.excitation().cut_short();
  EXPECT_TRUE(records_.is_over_in("acs", 1));
}

} // namespace
} // namespace dyncal::inline evaluation
