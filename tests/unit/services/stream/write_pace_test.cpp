#include "services/stream/write_pace.hpp"

#include <random>

#include <gtest/gtest.h>

namespace dyncal::inline stream {
namespace {

using namespace std::chrono_literals;

class WritePaceTest : public testing::Test {
protected:
  // Writes until it has to wait.
  int write_on(int at_most = 1000, std::size_t bytes = 10) {
    int written = 0;
    while (written < at_most && pace_.may_write(now_, [this] { return acknowledged_; })) {
      pace_.wrote(bytes);
      ++written;
    }
    return written;
  }

  WritePace pace_{{.messages = 50, .bytes = 10'000}, 1s};
  WritePace::Instant now_{std::chrono::hours(1)};
  bool acknowledged_ = false;
};

TEST_F(WritePaceTest, StopsAfterAWindowUntilAllIsAcknowledged) {
  EXPECT_EQ(write_on(), 50);
  now_ += 900ms;
  EXPECT_EQ(write_on(), 0);
  acknowledged_ = true;
  EXPECT_EQ(write_on(1), 1);
  acknowledged_ = false;
  EXPECT_EQ(write_on(), 49);
}

TEST_F(WritePaceTest, AWindowIsFullOfBytesAsWell) {
  EXPECT_EQ(write_on(1000, 1000), 10);
}

TEST_F(WritePaceTest, NeverWaitsWhileEverybodyKeepsUp) {
  acknowledged_ = true;
  EXPECT_EQ(write_on(1000), 1000);
}

TEST_F(WritePaceTest, WaitsForAReaderThatHangsOnceAndNoLonger) {
  EXPECT_EQ(write_on(), 50);
  now_ += 500ms;
  EXPECT_EQ(write_on(), 0);
  now_ += 501ms;
  EXPECT_FALSE(pace_.hanging());
  write_on(1);
  now_ += 1000ms;
  EXPECT_EQ(write_on(1000), 1000);
  EXPECT_TRUE(pace_.hanging());
  acknowledged_ = true;
  write_on(51);
  acknowledged_ = false;
  EXPECT_FALSE(pace_.hanging());
  EXPECT_LT(write_on(), 50);
}

// How many blocks wait after a minute of an instrument, whose readers acknowledge what they have
// once it was written for a time of 0.2 to 0.8 s: a busy computer.
std::size_t waiting_after_a_minute(WritePace::Window window, std::chrono::nanoseconds block,
                                   std::size_t bytes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> answer_ms(200, 800);
  WritePace pace(window, 2s);
  const WritePace::Instant begin(std::chrono::hours(1));
  WritePace::Instant acknowledged = begin;
  std::size_t written = 0;
  std::size_t offered = 0;
  for (auto now = begin; now < begin + 1min; now += block) {
    ++offered;
    while (written < offered && pace.may_write(now, [&] { return now >= acknowledged; })) {
      pace.wrote(bytes);
      ++written;
      acknowledged = now + std::chrono::milliseconds(answer_ms(random));
    }
    EXPECT_FALSE(pace.hanging());
  }
  return offered - written;
}

// 20 kS/s of two channels: 62 samples are one packet. 0.8 s of it may wait for an answer.
TEST(PaceWindow, BlocksOfOnePacketKeepUpWhereAnswersAreSlow) {
  constexpr auto block = 3'100us;
  constexpr std::size_t bytes = 1'300;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_LE(waiting_after_a_minute(pace_window(SourceKind::acs, max_secured_block_bytes), block,
                                     bytes, seed),
              800ms / block + 1);
    EXPECT_GT(
        waiting_after_a_minute(pace_window(SourceKind::acs, max_block_bytes), block, bytes, seed),
        5'000U)
        << "the window of long blocks is long enough: this test shows nothing";
  }
}

TEST(PaceWindow, IsLessThanHalfOfWhatIsKeptForRepairsOfBlocksAndOfRecords) {
  const auto messages = [](SourceKind kind, std::size_t block_bytes) {
    return static_cast<int>(pace_window(kind, block_bytes).messages);
  };
  EXPECT_EQ(messages(SourceKind::dau, max_block_bytes), 100);
  EXPECT_EQ(messages(SourceKind::dau, max_secured_block_bytes), 800);
  EXPECT_LT(2 * 100, bus::repair_blocks);
  EXPECT_LT(2 * 800, bus::secured_blocks_per_block * bus::repair_blocks);
  // Records are not split, and a writer keeps as many where it is secured.
  for (const std::size_t block_bytes : {max_block_bytes, max_secured_block_bytes}) {
    for (const SourceKind kind : {SourceKind::dso, SourceKind::tss}) {
      EXPECT_GT(messages(kind, block_bytes), 1);
      EXPECT_LT(2 * messages(kind, block_bytes), bus::repair_records);
    }
  }
}

} // namespace
} // namespace dyncal::inline stream
