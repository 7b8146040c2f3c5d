#include "services/contract/source_block.hpp"

#include <gtest/gtest.h>

#include "idl/dyncal.h"

namespace dyncal::inline contract {
namespace {

wire::SampleBlock regular_message() {
  wire::SampleBlock message;
  message.session(7);
  message.block(3);
  message.first_sample(10);
  message.sample_count(2);
  message.channel_count(2);
  message.origin_ns(1000);
  message.interval_numerator_ns(100);
  message.interval_denominator(1);
  message.values({1.0, 2.0, 3.0, 4.0});
  return message;
}

TEST(SourceBlock, SeesWhatTheMessageHolds) {
  const wire::SampleBlock message = regular_message();
  const SourceBlock block = view_block(message);
  EXPECT_TRUE(block.is_consistent());
  EXPECT_EQ(block.session, 7U);
  EXPECT_EQ(block.number, 3U);
  EXPECT_EQ(block.values.data(), message.values().data());
  EXPECT_EQ(block.first_stamp_ns(), 2000);
  EXPECT_EQ(block.last_stamp_ns(), 2100);
}

TEST(SourceBlock, OfADriverIsTheSameAsOfItsMessage) {
  drivers::SampleBlock samples;
  samples.first_sample = 10;
  samples.samples = 2;
  samples.clock = drivers::RegularClock{1000, 100, 1};
  samples.values = {1.0, 2.0, 3.0, 4.0};
  const SourceBlock block = view_block(samples, 7, 3);
  EXPECT_TRUE(block.is_consistent());
  EXPECT_EQ(block.channels, 2U);
  EXPECT_EQ(block.last_stamp_ns(), 2100);
  samples.clock.reset(); // neither clock nor stamps
  EXPECT_FALSE(view_block(samples, 7, 3).is_consistent());
}

TEST(SourceBlock, FindsSizesThatContradictEachOther) {
  wire::SampleBlock message = regular_message();
  message.values().pop_back();
  EXPECT_FALSE(view_block(message).is_consistent());
  message = regular_message();
  message.stamps_ns({1});
  EXPECT_FALSE(view_block(message).is_consistent());
  message = regular_message();
  message.stamp_flags({0, 0, 0});
  EXPECT_FALSE(view_block(message).is_consistent());
  message = regular_message();
  message.interval_denominator(0);
  EXPECT_FALSE(view_block(message).is_consistent());
}

} // namespace
} // namespace dyncal::inline contract
