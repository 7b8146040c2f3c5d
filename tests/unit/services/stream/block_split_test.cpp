#include "services/stream/block_split.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline stream {
namespace {

drivers::SampleBlock long_block(std::size_t samples, std::size_t channels, bool stamped) {
  drivers::SampleBlock block;
  block.first_sample = 1'000'000;
  block.samples = samples;
  block.received_utc_ns = 42;
  for (std::size_t i = 0; i < samples * channels; ++i) {
    block.values.push_back(static_cast<double>(i) * 0.1);
  }
  if (!stamped) {
    block.clock = drivers::RegularClock{
        .origin_ns = 5, .interval_numerator_ns = 1'000'000'007, .interval_denominator = 50'021};
    return block;
  }
  for (std::size_t i = 0; i < samples; ++i) {
    block.stamps_ns.push_back(static_cast<std::int64_t>(i * 1001));
    block.stamp_uncertainty_ns.push_back(static_cast<std::uint32_t>(i));
    block.flags.push_back(static_cast<std::uint8_t>(i));
  }
  return block;
}

void expect_same_samples(const drivers::SampleBlock& whole,
                         const std::vector<drivers::SampleBlock>& parts) {
  const std::size_t channels = whole.values.size() / whole.samples;
  std::size_t done = 0;
  for (const drivers::SampleBlock& part : parts) {
    ASSERT_EQ(part.first_sample, whole.first_sample + done);
    ASSERT_EQ(part.values.size(), part.samples * channels);
    ASSERT_EQ(part.stamps_ns.size(), whole.stamps_ns.empty() ? 0 : part.samples);
    EXPECT_EQ(part.received_utc_ns, whole.received_utc_ns);
    EXPECT_EQ(part.clock.has_value(), whole.clock.has_value());
    for (std::size_t i = 0; i < part.samples; ++i, ++done) {
      for (std::size_t channel = 0; channel < channels; ++channel) {
        ASSERT_EQ(part.values[channel * part.samples + i],
                  whole.values[channel * whole.samples + done]);
      }
      if (!whole.stamps_ns.empty()) {
        ASSERT_EQ(part.stamps_ns[i], whole.stamps_ns[done]);
        ASSERT_EQ(part.stamp_uncertainty_ns[i], whole.stamp_uncertainty_ns[done]);
        ASSERT_EQ(part.flags[i], whole.flags[done]);
      }
      if (whole.clock) {
        ASSERT_EQ(part.clock->stamp_ns(part.first_sample + i),
                  whole.clock->stamp_ns(whole.first_sample + done));
      }
    }
  }
  EXPECT_EQ(done, whole.samples);
}

TEST(BlockSplit, MakesShortBlocksOfTheSameSamplesOutOfALongFrame) {
  for (const bool stamped : {false, true}) {
    const auto whole = long_block(65536, 2, stamped);
    const auto parts = split(whole);
    expect_same_samples(whole, parts);
    EXPECT_GE(parts.size(), 16U);
    for (const auto& part : parts) {
      EXPECT_LE(part.samples * (2 * 8 + (stamped ? 13 : 0)), max_block_bytes);
    }
  }
}

TEST(BlockSplit, LeavesAShortBlockAsItIs) {
  const auto whole = long_block(1000, 2, false); // 20 ms at 50 kS/s
  const auto parts = split(whole);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].values, whole.values);
}

TEST(BlockSplit, NeverDividesASample) {
  const auto whole = long_block(3, 5, true);
  const auto parts = split(whole, 10);
  EXPECT_EQ(parts.size(), 3U);
  expect_same_samples(whole, parts);
}

} // namespace
} // namespace dyncal::inline stream
