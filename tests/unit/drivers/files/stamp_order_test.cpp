#include "drivers/files/stamp_order.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace dyncal::drivers::files {
namespace {

std::vector<std::uint8_t> flags_of(StampOrder& order, std::vector<std::int64_t> stamps_ns) {
  SampleBlock block;
  block.samples = stamps_ns.size();
  block.stamps_ns = std::move(stamps_ns);
  order.check(block);
  return block.flags;
}

using Flags = std::vector<std::uint8_t>;

TEST(StampOrder, FlagsNothingThatRises) {
  StampOrder order;
  EXPECT_EQ(flags_of(order, {1, 2, 5, 6}), Flags{});
  EXPECT_EQ(flags_of(order, {7, 100}), Flags{});
}

TEST(StampOrder, FlagsDuplicateAndBackwardStampsAcrossBlocks) {
  StampOrder order;
  EXPECT_EQ(flags_of(order, {10, 20, 20, 40}), (Flags{0, 0, stamp_repeated, 0}));
  EXPECT_EQ(flags_of(order, {40, 30, 41}), (Flags{stamp_repeated, stamp_backwards, 0}));
}

TEST(StampOrder, FlagsStampsThatAreTooFarAhead) {
  constexpr std::int64_t second = 1'000'000'000;
  constexpr auto ahead = static_cast<std::uint8_t>(stamp_second_slip);
  constexpr auto below = static_cast<std::uint8_t>(stamp_offset_below_second);
  StampOrder order;
  EXPECT_EQ(flags_of(order, {10, 20, 200'000 * second, 40, 50}), (Flags{0, 0, ahead, 0, 0}));
  EXPECT_EQ(flags_of(order, {60, 70, 90'000, 90'010, 100, 110}), (Flags{0, 0, below, below, 0, 0}));
  EXPECT_EQ(flags_of(order, {120, 200'000 * second}), (Flags{0, ahead})); // nothing tells
  EXPECT_EQ(flags_of(order, {140, 150}), Flags{});
  // A pause, or a clock that was put forward for good.
  EXPECT_EQ(flags_of(order, {160, 9 * second, 9 * second + 10, 9 * second + 20}), Flags{});
}

TEST(StampOrder, TrustsStampsAgainWhenTimeWasSetBack) {
  StampOrder order;
  EXPECT_EQ(flags_of(order, {1000, 1001}), Flags{});
  constexpr auto back = static_cast<std::uint8_t>(stamp_backwards);
  EXPECT_EQ(flags_of(order, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}),
            (Flags{back, back, back, back, back, back, back, back, 0, 0}));
}

} // namespace
} // namespace dyncal::drivers::files
