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

TEST(StampOrder, TrustsStampsAgainWhenTimeWasSetBack) {
  StampOrder order;
  EXPECT_EQ(flags_of(order, {1000, 1001}), Flags{});
  constexpr auto back = static_cast<std::uint8_t>(stamp_backwards);
  EXPECT_EQ(flags_of(order, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}),
            (Flags{back, back, back, back, back, back, back, back, 0, 0}));
}

} // namespace
} // namespace dyncal::drivers::files
