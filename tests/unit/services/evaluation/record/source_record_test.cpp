#include "services/evaluation/record/source_record.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

TEST(SourceRecord, HoldsTheSameSamplesHoweverTheyWereCut) {
  SourceRecord coarse("dau");
  SourceRecord fine("dau");
  tests::SyntheticRun run;
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    ASSERT_TRUE(tests::feed(coarse, block));
  }
  run.block_samples = 7;
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    ASSERT_TRUE(tests::feed(fine, block));
  }
  EXPECT_TRUE(std::equal(coarse.stamps_ns().begin(), coarse.stamps_ns().end(),
                         fine.stamps_ns().begin(), fine.stamps_ns().end()));
  EXPECT_TRUE(std::equal(coarse.column(0).begin(), coarse.column(0).end(), fine.column(0).begin(),
                         fine.column(0).end()));
  EXPECT_TRUE(fine.ended());
}

TEST(SourceRecord, MakesStampsOfARegularClock) {
  SourceRecord record("acs");
  tests::feed(record, tests::SyntheticRun{}.acs_blocks()[1]);
  EXPECT_EQ(record.stamps_ns().front(), 500 * 100'000);
  EXPECT_EQ(record.stamps_ns()[3], 503 * 100'000);
}

TEST(SourceRecord, CountsALostBlockBetweenItsNeighboursStamps) {
  SourceRecord record("dau");
  tests::SyntheticRun run;
  run.lost_block = 3;
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    tests::feed(record, block);
  }
  EXPECT_EQ(record.lost(), 50U);
  const auto stamps = record.stamps_ns();
  EXPECT_EQ(record.lost_in({stamps.front(), stamps.back()}).missing, 50U);
  EXPECT_EQ(record.lost_in({stamps[400], stamps.back()}).missing, 0U);
}

TEST(SourceRecord, ForgetsFromTheFrontOnly) {
  SourceRecord record("acs");
  for (const wire::SampleBlock& block : tests::SyntheticRun{}.acs_blocks()) {
    tests::feed(record, block);
  }
  const std::size_t all = record.stamps_ns().size();
  record.forget_before(1'000'000'000);
  EXPECT_EQ(record.forgotten(), 10'000U);
  EXPECT_EQ(record.stamps_ns().size(), all - 10'000U);
  EXPECT_EQ(record.stamps_ns().front(), 1'000'000'000);
  EXPECT_EQ(record.column(0).size(), record.stamps_ns().size());
}

TEST(SourceRecord, GivesAwayAPartThatSaysTheSameOfItsTime) {
  SourceRecord record("dau");
  tests::SyntheticRun run;
  run.lost_block = 3;
  record.describe(contract::from_message(run.dau_description()));
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    tests::feed(record, block);
  }
  record.forget_before(record.stamps_ns()[20]);
  const auto stamps = record.stamps_ns();
  const SourceRecord part = record.part({stamps[100] - 1, stamps[900] + 1});
  ASSERT_EQ(part.stamps_ns().size(), 801U);
  EXPECT_EQ(part.flags().size(), 801U);
  EXPECT_TRUE(std::equal(part.stamps_ns().begin(), part.stamps_ns().end(), stamps.begin() + 100));
  for (std::size_t channel = 0; channel < run.dau_description().channels().size(); ++channel) {
    EXPECT_TRUE(std::equal(part.column(channel).begin(), part.column(channel).end(),
                           record.column(channel).begin() + 100));
  }
  const TimeInterval inside{stamps[100], stamps[900]};
  EXPECT_EQ(part.lost_in(inside).missing, 50U);
  EXPECT_EQ(record.lost_in(inside).missing, 50U);
  EXPECT_EQ(part.stamp_uncertainty_s(inside), record.stamp_uncertainty_s(inside));
  EXPECT_EQ(part.source(), "dau");
  EXPECT_TRUE(record.part({stamps.back() + 1, stamps.back() + 2}).stamps_ns().empty());
}

TEST(SourceRecord, KeepsOnlyTheChannelsThatAreAskedFor) {
  const tests::SyntheticRun run;
  SourceRecord all("dau");
  SourceRecord one("dau");
  one.keep_only({1});
  for (const wire::SampleBlock& block : run.dau_blocks()) {
    tests::feed(all, block);
    tests::feed(one, block);
  }
  const std::int64_t since_ns = all.stamps_ns()[all.stamps_ns().size() / 2];
  all.forget_before(since_ns);
  one.forget_before(since_ns);
  EXPECT_TRUE(one.column(0).empty());
  ASSERT_EQ(one.column(1).size(), all.column(1).size());
  EXPECT_TRUE(std::equal(one.column(1).begin(), one.column(1).end(), all.column(1).begin()));
  EXPECT_EQ(one.part({since_ns, all.stamps_ns().back()}).column(1).size(), all.column(1).size());
  one.keep_only({0});
  EXPECT_TRUE(one.column(1).empty());
  ASSERT_EQ(one.column(0).size(), all.column(0).size());
  EXPECT_TRUE(std::isnan(one.column(0).front()));
}

TEST(SourceRecord, DropsWhatWasBufferedWhenTheSourceStartsAnew) {
  SourceRecord record("acs");
  const auto blocks = tests::SyntheticRun{}.acs_blocks();
  tests::feed(record, blocks[0]);
  wire::SampleBlock restarted = blocks[0];
  restarted.session(8);
  tests::feed(record, restarted);
  EXPECT_EQ(record.restarts(), 1U);
  EXPECT_EQ(record.stamps_ns().size(), blocks[0].sample_count());
}

TEST(SourceRecord, RefusesBlocksWhoseSizesContradictEachOther) {
  SourceRecord record("acs");
  wire::SampleBlock block = tests::SyntheticRun{}.acs_blocks()[0];
  block.values().pop_back();
  EXPECT_FALSE(tests::feed(record, block));
  EXPECT_EQ(record.unusable_blocks(), 1U);
  EXPECT_TRUE(record.stamps_ns().empty());
}

TEST(SourceRecord, KeepsItsBoundAndCountsWhatItDrops) {
  SourceRecord record("acs", 1000);
  for (const wire::SampleBlock& block : tests::SyntheticRun{}.acs_blocks()) {
    tests::feed(record, block);
  }
  EXPECT_EQ(record.stamps_ns().size(), 1000U);
  EXPECT_GT(record.overflowed(), 0U);
}

} // namespace
} // namespace dyncal::inline evaluation
