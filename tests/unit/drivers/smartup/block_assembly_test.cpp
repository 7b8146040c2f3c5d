#include "drivers/smartup/block_assembly.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::drivers::smartup {
namespace {

constexpr std::int64_t block_ns = 50'000'000;
constexpr double period_ns = 1e6;

SampleRow row(std::uint64_t sample) {
  SampleRow row;
  row.sample = sample;
  row.stamp_ns = static_cast<std::int64_t>(sample) * 1'000'000;
  row.stamp_uncertainty_ns = 21;
  row.present = 0b101;
  row.values[0] = static_cast<float>(sample);
  row.values[2] = -static_cast<float>(sample);
  return row;
}

HostTime at_ms(std::int64_t ms) {
  return {ms * 1'000'000, 7'000'000'000 + ms * 1'000'000};
}

BlockAssembly assembly() {
  BlockAssembly blocks(block_ns);
  blocks.set_columns({.own = 0b101, .sync = 0});
  return blocks;
}

TEST(BlockAssembly, CutsFiftyMilliseconds) {
  auto blocks = assembly();
  std::vector<SampleBlock> ready;
  for (std::uint64_t n = 1; n <= 200; ++n) {
    if (auto block = blocks.add(row(n), period_ns, at_ms(static_cast<std::int64_t>(n)))) {
      ready.push_back(std::move(*block));
    }
  }
  ASSERT_EQ(ready.size(), 4U);
  EXPECT_EQ(ready[1].first_sample, 51U);
  EXPECT_EQ(ready[1].samples, 50U);
  ASSERT_EQ(ready[1].values.size(), 100U);
  EXPECT_EQ(ready[1].values[0], 51.0);   // first column
  EXPECT_EQ(ready[1].values[50], -51.0); // second column
  EXPECT_EQ(ready[1].stamps_ns[49], 100'000'000);
  EXPECT_EQ(ready[1].stamp_uncertainty_ns[0], 21U);
  EXPECT_TRUE(ready[1].flags.empty());
  EXPECT_EQ(ready[1].received_utc_ns, at_ms(100).utc_ns);
}

TEST(BlockAssembly, AGapEndsTheBlock) {
  auto blocks = assembly();
  for (std::uint64_t n = 1; n <= 10; ++n) {
    EXPECT_FALSE(blocks.add(row(n), period_ns, at_ms(0)));
  }
  const auto block = blocks.add(row(12), period_ns, at_ms(0));
  ASSERT_TRUE(block);
  EXPECT_EQ(block->samples, 10U);
  EXPECT_EQ(blocks.flush()->first_sample, 12U);
}

TEST(BlockAssembly, ABlockOfASlowSensorIsFlushedByTime) {
  auto blocks = assembly();
  EXPECT_FALSE(blocks.add(row(1), 0.0, at_ms(0)));
  EXPECT_FALSE(blocks.flush(at_ms(99)));
  EXPECT_TRUE(blocks.flush(at_ms(100)));
  EXPECT_FALSE(blocks.flush());
}

TEST(BlockAssembly, WhatWasNotMeasuredIsNotANumber) {
  auto blocks = assembly();
  auto sparse = row(1);
  sparse.present = 0b001;
  (void)blocks.add(sparse, period_ns, at_ms(0));
  const auto block = blocks.flush();
  ASSERT_TRUE(block);
  EXPECT_EQ(block->values[0], 1.0);
  EXPECT_TRUE(std::isnan(block->values[1]));
}

TEST(BlockAssembly, FlagsOfOneSampleComeWithAllOfItsBlock) {
  auto blocks = assembly();
  (void)blocks.add(row(1), period_ns, at_ms(0));
  auto flagged = row(2);
  flagged.flags = stamp_repeated;
  (void)blocks.add(flagged, period_ns, at_ms(0));
  EXPECT_EQ(blocks.flush()->flags, (std::vector<std::uint8_t>{0, stamp_repeated}));
}

TEST(BlockAssembly, SyncColumnsFollowTheSensorsOwn) {
  BlockAssembly blocks(block_ns);
  blocks.set_columns({.own = 0b101, .sync = 0b010});
  auto joined = row(1);
  joined.sync_present = 0b010;
  joined.sync_values[1] = 9.0F;
  (void)blocks.add(joined, period_ns, at_ms(0));
  EXPECT_EQ(blocks.flush()->values, (std::vector<double>{1.0, -1.0, 9.0}));
}

} // namespace
} // namespace dyncal::drivers::smartup
