#include "services/evaluation/record/sent_blocks.hpp"

#include <array>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t host_ns = 3'600'000 * ms; // of the source's host behind the listener's

class SentBlocksTest : public testing::Test {
protected:
  // Of two samples, 10 ms apart; sent with the second.
  void add(std::uint64_t number, std::int64_t last_ns, std::int64_t sent_ns, std::int64_t delay_ns,
           std::uint64_t session = 1) {
    const std::array<std::int64_t, 2> stamps{last_ns - 10 * ms, last_ns};
    const std::array<double, 2> values{};
    SourceBlock block;
    block.session = session;
    block.number = number;
    block.samples = 2;
    block.channels = 1;
    block.stamps_ns = stamps;
    block.values = values;
    blocks_.add(block, {sent_ns + host_ns, sent_ns + delay_ns});
  }
  void expect(std::int64_t heard_ns, std::int64_t stamp_ns, bool is_between) const {
    const auto instant = blocks_.at(heard_ns);
    ASSERT_TRUE(instant);
    EXPECT_EQ(instant->stamp_ns, stamp_ns);
    EXPECT_EQ(instant->is_between_samples, is_between);
  }

  SentBlocks blocks_;
};

TEST_F(SentBlocksTest, KnowNothingBeforeTheFirstBlock) {
  EXPECT_FALSE(blocks_.at(0));
}

TEST_F(SentBlocksTest, InterpolateAlsoWhatCameLate) {
  add(0, 500 * ms, 1000 * ms, 700 * ms);
  add(1, 520 * ms, 1020 * ms, 680 * ms);
  expect(1700 * ms, 520 * ms + 1, false); // as if it had been sent when it was heard
  add(2, 540 * ms, 1040 * ms, 0);
  expect(1010 * ms, 510 * ms, true);
  expect(1030 * ms, 530 * ms, true);
}

TEST_F(SentBlocksTest, KnowHowFarTheClocksAreApartFromTheSessionBefore) {
  add(0, 500 * ms, 1000 * ms, 0);
  add(0, 20 * ms, 2000 * ms, 700 * ms, 2);
  add(1, 40 * ms, 2020 * ms, 700 * ms, 2);
  expect(2010 * ms, 30 * ms, true);
}

TEST_F(SentBlocksTest, TakeNoStampOfWhereNothingIs) {
  add(0, 500 * ms, 1000 * ms, 0);
  add(3, 560 * ms, 1060 * ms, 0);
  expect(900 * ms, 490 * ms - 1, false);
  expect(1030 * ms, 500 * ms + 1, false);
  expect(2000 * ms, 560 * ms + 1, false);
}

TEST_F(SentBlocksTest, BeginAnewWithASession) {
  add(0, 500 * ms, 1000 * ms, 0);
  add(0, 20 * ms, 2000 * ms, 0, 2);
  expect(1500 * ms, 10 * ms - 1, false);
}

// Stamps are later than they were then, never earlier: no step is refused for it.
TEST_F(SentBlocksTest, AllowForAHostWhoseClockIsSetBack) {
  add(0, 500 * ms, 1000 * ms, 0);
  add(1, 520 * ms, -8980 * ms, 10'000 * ms);
  const auto instant = blocks_.at(1010 * ms);
  ASSERT_TRUE(instant);
  EXPECT_GE(instant->stamp_ns, 510 * ms);
}

} // namespace
} // namespace dyncal::inline evaluation
