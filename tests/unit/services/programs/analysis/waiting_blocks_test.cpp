// Blocks that wait: their order, whose they are, and what happens at the bound.
#include "services/programs/analysis/waiting_blocks.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "services/programs/analysis/stream_follower.hpp"

namespace dyncal::inline programs {
namespace {

using Numbers = std::vector<std::uint64_t>;

wire::SampleBlock block(std::uint64_t number, std::uint64_t session = 7) {
  wire::SampleBlock one;
  one.session(session);
  one.block(number);
  one.values(std::vector<double>(100));
  return one;
}

Numbers taken_off(WaitingBlocks& waiting) {
  Numbers numbers;
  while (!waiting.empty()) {
    numbers.push_back(waiting.oldest().block());
    waiting.take_off_oldest();
  }
  return numbers;
}

TEST(WaitingBlocks, GivesTheOldestFirst) {
  WaitingBlocks waiting;
  EXPECT_TRUE(waiting.empty());
  for (const std::uint64_t number : {4, 5, 6}) {
    waiting.add(block(number));
  }
  EXPECT_EQ(taken_off(waiting), (Numbers{4, 5, 6}));
}

TEST(WaitingBlocks, ThrowsTheOldestAwayAtItsBound) {
  WaitingBlocks waiting(3 * bytes_of(block(0)));
  for (std::uint64_t number = 0; number < 10; ++number) {
    waiting.add(block(number));
  }
  EXPECT_EQ(taken_off(waiting), (Numbers{7, 8, 9}));
}

TEST(WaitingBlocks, LeavesOutASessionAndHasItsRoomAgain) {
  WaitingBlocks waiting(3 * bytes_of(block(0)));
  waiting.add(block(0, 7));
  waiting.add(block(0, 8));
  waiting.add(block(1, 8));
  waiting.leave_out_session(8);
  waiting.add(block(1, 7));
  waiting.add(block(2, 7));
  EXPECT_EQ(taken_off(waiting), (Numbers{0, 1, 2}));
}

} // namespace
} // namespace dyncal::inline programs
