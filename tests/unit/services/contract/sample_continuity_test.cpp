#include "services/contract/sample_continuity.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

SourceBlock block_of(std::uint64_t session, std::uint64_t number, std::uint64_t first_sample,
                     std::size_t samples) {
  SourceBlock block;
  block.session = session;
  block.number = number;
  block.first_sample = first_sample;
  block.samples = samples;
  return block;
}

TEST(SampleContinuity, FindsNothingInAnUnbrokenStream) {
  SampleContinuity continuity;
  EXPECT_TRUE(continuity.add(block_of(7, 0, 1000, 50)).first);
  for (std::uint64_t i = 1; i < 100; ++i) {
    EXPECT_TRUE(continuity.add(block_of(7, i, 1000 + 50 * i, 50)).continuous());
  }
  const ContinuityCounts counts = continuity.counts();
  EXPECT_EQ(counts.blocks, 100U);
  EXPECT_EQ(counts.samples, 5000U);
  EXPECT_EQ(counts.sessions, 1U);
  EXPECT_EQ(counts.missing_blocks + counts.missing_samples + counts.duplicates +
                counts.repeated_samples,
            0U);
}

TEST(SampleContinuity, CountsNothingAsMissingBeforeTheFirstBlockHeard) {
  SampleContinuity continuity;
  const ContinuityFinding finding = continuity.add(block_of(7, 412, 20600, 50));
  EXPECT_TRUE(finding.first);
  EXPECT_TRUE(finding.continuous());
}

TEST(SampleContinuity, CountsBlocksLostOnTheBusWithTheirSamples) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  const ContinuityFinding finding = continuity.add(block_of(7, 4, 200, 50));
  EXPECT_EQ(finding.missing_blocks, 3U);
  EXPECT_EQ(finding.missing_samples, 150U);
  EXPECT_FALSE(finding.continuous());
}

TEST(SampleContinuity, CountsSamplesLostBeforeTheBus) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  const ContinuityFinding finding = continuity.add(block_of(7, 1, 51, 49));
  EXPECT_EQ(finding.missing_blocks, 0U);
  EXPECT_EQ(finding.missing_samples, 1U);
}

TEST(SampleContinuity, TakesEmptyBlocksIntoTheNumberingOfBlocksOnly) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  EXPECT_TRUE(continuity.add(block_of(7, 1, 0, 0)).continuous());
  EXPECT_TRUE(continuity.add(block_of(7, 2, 50, 50)).continuous());
  EXPECT_EQ(continuity.add(block_of(7, 4, 100, 50)).missing_blocks, 1U);
}

TEST(SampleContinuity, FindsDuplicatesAndLeavesThemOutOfTheCounts) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  continuity.add(block_of(7, 1, 50, 50));
  EXPECT_TRUE(continuity.add(block_of(7, 1, 50, 50)).duplicate);
  EXPECT_TRUE(continuity.add(block_of(7, 0, 0, 50)).duplicate);
  EXPECT_TRUE(continuity.add(block_of(7, 2, 100, 50)).continuous());
  EXPECT_EQ(continuity.counts().duplicates, 2U);
  EXPECT_EQ(continuity.counts().samples, 150U);
}

TEST(SampleContinuity, FindsSamplesThatCameTwiceInDifferentBlocks) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  EXPECT_EQ(continuity.add(block_of(7, 1, 40, 20)).repeated_samples, 10U);
  EXPECT_TRUE(continuity.add(block_of(7, 2, 60, 50)).continuous());
}

TEST(SampleContinuity, StartsAnewWithASessionAndMissesItsFirstBlocks) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  const ContinuityFinding clean = continuity.add(block_of(8, 0, 700, 50));
  EXPECT_TRUE(clean.new_session);
  EXPECT_EQ(clean.missing_samples, 0U);
  const ContinuityFinding late = continuity.add(block_of(9, 2, 100, 50));
  EXPECT_TRUE(late.new_session);
  EXPECT_EQ(late.missing_blocks, 2U);
  EXPECT_EQ(continuity.counts().sessions, 3U);
}

TEST(SampleContinuity, CountsSamplesOfAnUnusableBlockAsMissing) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  EXPECT_EQ(continuity.add(block_of(7, 1, 50, 50), BlockUse::unusable).missing_samples, 0U);
  EXPECT_EQ(continuity.pending_samples(), 50U);
  const ContinuityFinding finding = continuity.add(block_of(7, 2, 100, 50));
  EXPECT_EQ(finding.missing_blocks, 0U);
  EXPECT_EQ(finding.missing_samples, 50U);
  EXPECT_EQ(finding.unusable_samples, 50U);
  EXPECT_EQ(continuity.pending_samples(), 0U);
  EXPECT_EQ(continuity.counts().unusable_blocks, 1U);
}

TEST(SampleContinuity, BelievesTheNumbersOfSamplesMoreThanAnUnusableBlock) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50));
  continuity.add(block_of(7, 1, 50, 4'000'000'000), BlockUse::unusable);
  const ContinuityFinding finding = continuity.add(block_of(7, 2, 60, 50));
  EXPECT_EQ(finding.missing_samples, 10U);
  EXPECT_EQ(finding.unusable_samples, 10U);
}

TEST(SampleContinuity, CountsAnUnusableFirstBlockAsItTells) {
  SampleContinuity continuity;
  continuity.add(block_of(7, 0, 0, 50), BlockUse::unusable);
  EXPECT_EQ(continuity.add(block_of(7, 1, 50, 50)).missing_samples, 50U);
}

} // namespace
} // namespace dyncal::inline contract
