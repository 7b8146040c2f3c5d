#include "drivers/sample_counts.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers {
namespace {

SampleBlock block_from(std::uint64_t first, std::size_t samples) {
  SampleBlock block;
  block.first_sample = first;
  block.samples = samples;
  return block;
}

TEST(SampleCounts, CountAGapBetweenBlocksAsLostInTheDevice) {
  SampleCounts counts;
  std::optional<std::uint64_t> next;
  counts.add(block_from(100, 10), next); // a session may begin anywhere
  EXPECT_EQ(counts.lost_in_device, 0U);
  counts.add(block_from(110, 10), next);
  counts.add(block_from(127, 3), next);
  EXPECT_EQ(counts.received, 23U);
  EXPECT_EQ(counts.lost_in_device, 7U);
  next.reset(); // a new session
  counts.add(block_from(0, 5), next);
  EXPECT_EQ(counts.received, 28U);
  EXPECT_EQ(counts.lost_in_device, 7U);
}

TEST(SampleCounts, ListOnlyCausesThatHappened) {
  SampleCounts counts;
  counts.add_cause("late", 0);
  counts.add_cause("stale", 2);
  EXPECT_EQ(counts.causes, (std::vector<NamedCount>{{"stale", 2}}));
}

} // namespace
} // namespace dyncal::drivers
