#include "services/stream/block_ring.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace dyncal::inline stream {
namespace {

using Clock = std::chrono::steady_clock;

RingEntry entry(std::uint64_t first_sample, Clock::time_point offered = {},
                std::size_t samples = 50) {
  RingEntry entry;
  entry.block.first_sample = first_sample;
  entry.block.samples = samples;
  entry.block.values.resize(samples);
  entry.offered = offered;
  return entry;
}

constexpr Clock::time_point start{std::chrono::seconds(1000)};

TEST(BlockRing, KeepsTheOrder) {
  BlockRing ring({});
  EXPECT_TRUE(ring.empty());
  for (std::uint64_t n = 0; n < 100; ++n) {
    EXPECT_TRUE(ring.offer(entry(n)));
  }
  for (std::uint64_t n = 0; n < 100; ++n) {
    EXPECT_EQ(ring.take()->block.first_sample, n);
  }
  EXPECT_FALSE(ring.take());
}

TEST(BlockRing, HoldsSixtySecondsOfALiveSourceAndThenDropsTheNewest) {
  BlockRing ring({});
  const auto block = std::chrono::milliseconds(50);
  int taken = 0;
  for (int n = 0; n < 1400; ++n) {
    taken += ring.offer(entry(static_cast<std::uint64_t>(n), start + n * block)) ? 1 : 0;
  }
  EXPECT_EQ(taken, 60 * 20 + 1);
  EXPECT_EQ(ring.dropped(), (1400U - 1201U) * 50U);
  EXPECT_DOUBLE_EQ(ring.fill(), 1.0);
  EXPECT_EQ(ring.take()->block.first_sample, 0U);
  EXPECT_TRUE(ring.offer(entry(1400, start + 1201 * block)));
}

TEST(BlockRing, HoldsNoMoreBytesThanItsBound) {
  const auto size = held_bytes(entry(0).block);
  BlockRing ring({.span = std::chrono::hours(1), .bytes = 10 * size});
  int taken = 0;
  for (int n = 0; n < 20; ++n) {
    taken += ring.offer(entry(0, start)) ? 1 : 0;
  }
  EXPECT_EQ(taken, 10);
  EXPECT_NEAR(ring.fill(), 1.0, 1e-9);
}

TEST(BlockRing, TakesOneBlockHoweverLarge) {
  BlockRing ring({.span = std::chrono::seconds(1), .bytes = 10});
  EXPECT_TRUE(ring.offer(entry(0)));
  EXPECT_FALSE(ring.offer(entry(1)));
}

TEST(BlockRing, AlwaysTakesMarks) {
  BlockRing ring({.span = std::chrono::seconds(1), .bytes = 10});
  EXPECT_TRUE(ring.offer(entry(0)));
  RingEntry mark;
  mark.end_of_stream = true;
  mark.offered = start + std::chrono::hours(1);
  EXPECT_TRUE(ring.offer(mark));
}

TEST(BlockRing, AFileWaitsForRoom) {
  BlockRing ring({.span = std::chrono::seconds(1), .bytes = 10});
  std::stop_source stop;
  std::jthread file([&] {
    for (std::uint64_t n = 0; n < 50; ++n) {
      ring.offer_waiting(entry(n), stop.get_token());
    }
  });
  for (std::uint64_t n = 0; n < 50;) {
    if (const auto taken = ring.take()) {
      EXPECT_EQ(taken->block.first_sample, n++);
    } else {
      std::this_thread::yield();
    }
  }
  EXPECT_EQ(ring.dropped(), 0U);
}

TEST(BlockRing, ABriefWaitEndsWithALossThatIsCountedAndIsNotRepeated) {
  BlockRing ring({.span = std::chrono::seconds(1), .bytes = 10});
  const std::stop_source stop;
  const auto brief = std::chrono::milliseconds(50);
  EXPECT_TRUE(ring.offer_within(entry(0), brief, stop.get_token()));
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(ring.offer_within(entry(1), brief, stop.get_token()));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, brief);
  const std::uint64_t dropped = ring.dropped();
  EXPECT_GT(dropped, 0U);
  // With another limit it would wait for ever: the ring is still full, and it does not.
  EXPECT_FALSE(ring.offer_within(entry(2), std::chrono::hours(1), stop.get_token()));
  EXPECT_EQ(ring.dropped(), 2 * dropped);
  EXPECT_TRUE(ring.take());
  EXPECT_TRUE(ring.offer_within(entry(3), brief, stop.get_token()));
}

TEST(BlockRing, ABriefWaitEndsWhenThereIsRoom) {
  BlockRing ring({.span = std::chrono::seconds(1), .bytes = 10});
  const std::stop_source stop;
  ring.offer(entry(0));
  bool taken = false;
  std::jthread stream(
      [&] { taken = ring.offer_within(entry(1), std::chrono::hours(1), stop.get_token()); });
  EXPECT_TRUE(ring.take());
  stream.join();
  EXPECT_TRUE(taken);
  EXPECT_EQ(ring.dropped(), 0U);
}

TEST(BlockRing, DiscardsSamplesAndKeepsMarks) {
  BlockRing ring({.span = std::chrono::hours(1), .bytes = 1 << 20U});
  EXPECT_TRUE(ring.offer(entry(0)));
  RingEntry mark;
  mark.end_of_stream = true;
  EXPECT_TRUE(ring.offer(mark));
  ring.discard();
  EXPECT_EQ(ring.dropped(), 0U);
  const auto left = ring.take();
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->end_of_stream);
  EXPECT_TRUE(ring.empty());
}

TEST(BlockRing, WaitingEndsWhenStopIsRequested) {
  BlockRing ring({.span = std::chrono::seconds(1), .bytes = 10});
  std::stop_source stop;
  ring.offer(entry(0));
  bool taken = true;
  std::jthread file([&] { taken = ring.offer_waiting(entry(1), stop.get_token()); });
  stop.request_stop();
  file.join();
  EXPECT_FALSE(taken);
  EXPECT_EQ(ring.dropped(), 0U);
}

} // namespace
} // namespace dyncal::inline stream
