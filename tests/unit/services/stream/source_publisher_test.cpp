// The publisher as the sink of a driver, without a bus: sessions, the end of the stream, counts,
// and what happens when nobody takes the samples.
#include "services/stream/source_publisher.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/stream/messages.hpp"

namespace dyncal::inline stream {
namespace {

drivers::SampleBlock block_from(std::uint64_t first, std::size_t samples = 50) {
  drivers::SampleBlock block;
  block.first_sample = first;
  block.samples = samples;
  block.values.resize(samples);
  return block;
}

SourceOptions with_room_for_one() {
  SourceOptions options{.bench = "bench", .source = "dau", .kind = SourceKind::dau};
  options.ring.bytes = 1;
  return options;
}

class Publisher : public testing::Test {
protected:
  explicit Publisher(SourceOptions options = {.bench = "bench", .source = "dau"})
      : publisher(std::move(options), std::make_shared<bus::WakeUp>()) {}

  SourcePublisher publisher;
  drivers::SampleSink& sink = publisher;
};

TEST_F(Publisher, ANewSessionHasAnotherNumberUnlessTheOldOneIsUnused) {
  const auto first = publisher.snapshot().session;
  sink.begin_session();
  EXPECT_EQ(publisher.snapshot().session, first);
  sink.take(block_from(0));
  sink.begin_session();
  sink.take(block_from(0));
  EXPECT_EQ(publisher.ring().take()->session, first);
  const auto second = publisher.ring().take();
  ASSERT_TRUE(second);
  EXPECT_NE(second->session, first);
  EXPECT_EQ(second->session, publisher.snapshot().session);
}

TEST_F(Publisher, TheEndIsBehindTheLastBlockAndComesOnce) {
  sink.take(block_from(0));
  publisher.end();
  publisher.end();
  EXPECT_FALSE(publisher.ring().take()->end_of_stream);
  const auto end = publisher.ring().take();
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->end_of_stream);
  EXPECT_EQ(end->block.samples, 0U);
  EXPECT_TRUE(publisher.ring().empty());
  EXPECT_EQ(publisher.snapshot().stage, SourceStage::ended);
}

TEST_F(Publisher, NothingThatADriverCountsIsLostOnTheWayToTheStatus) {
  drivers::SampleCounts counts{.received = 1,
                               .lost_in_device = 2,
                               .lost_on_way = 3,
                               .duplicates = 4,
                               .rejected = 5,
                               .stamps_not_trusted = 6,
                               .causes = {{"late", 7}, {"stale", 8}},
                               .clock_uncertainty_s = 9e-9};
  sink.count(counts);
  const wire::SourceStatus status = to_message(publisher.options(), publisher.snapshot());
  EXPECT_EQ(status.received(), 1U);
  EXPECT_EQ(status.lost_in_device(), 2U);
  EXPECT_EQ(status.lost_in_transit(), 3U);
  EXPECT_EQ(status.duplicates(), 4U);
  EXPECT_EQ(status.rejected(), 5U);
  EXPECT_EQ(status.stamps_not_trusted(), 6U);
  ASSERT_EQ(status.causes().size(), 2U);
  EXPECT_EQ(status.causes().at(1).name(), "stale");
  EXPECT_EQ(status.causes().at(1).value(), 8U);
  EXPECT_EQ(status.clock_uncertainty_s(), 9e-9);
}

TEST_F(Publisher, ADescriptionIsHandedOverOnceUntilItChanges) {
  drivers::SourceDescription description;
  description.device = "unit";
  sink.describe(description);
  EXPECT_TRUE(publisher.take_changed_description());
  sink.describe(description);
  EXPECT_FALSE(publisher.take_changed_description());
  description.tick_s = 1e-9;
  sink.describe(description);
  ASSERT_TRUE(publisher.take_changed_description());
}

TEST_F(Publisher, SplitsALongFrameIntoBlocksOfOneSession) {
  sink.take(block_from(100, 65536));
  std::uint64_t next = 100;
  while (const auto entry = publisher.ring().take()) {
    EXPECT_EQ(entry->block.first_sample, next);
    EXPECT_LE(held_bytes(entry->block), std::size_t{80} << 10U);
    EXPECT_EQ(entry->session, publisher.session());
    next += entry->block.samples;
  }
  EXPECT_EQ(next, 100U + 65536U);
  EXPECT_EQ(publisher.snapshot().offered_samples, 65536U);
}

class FullPublisher : public Publisher {
protected:
  FullPublisher() : Publisher(with_room_for_one()) {}
};

TEST_F(FullPublisher, OfALiveDeviceDropsTheNewestBlockAndCountsIt) {
  sink.take(block_from(0));
  sink.take(block_from(50));
  EXPECT_EQ(publisher.ring().dropped(), 50U);
  EXPECT_EQ(publisher.ring().take()->block.first_sample, 0U);
  EXPECT_TRUE(publisher.ring().empty());
}

TEST_F(FullPublisher, CountsAShotAsOne) {
  EXPECT_TRUE(publisher.take_shot({.number = 1, .run = "run"}, block_from(0, 10'000)));
  EXPECT_FALSE(publisher.take_shot({.number = 2, .run = "run"}, block_from(0, 10'000)));
  EXPECT_EQ(publisher.ring().dropped(), 1U);
}

TEST(WaitingPublisher, OfAFileWaitsForRoomUntilItIsStopped) {
  std::stop_source stop;
  SourceOptions options = with_room_for_one();
  options.when_full = WhenFull::wait;
  options.stop = stop.get_token();
  SourcePublisher publisher(options, std::make_shared<bus::WakeUp>());
  publisher.take(block_from(0));
  std::jthread file([&] {
    publisher.take(block_from(50));  // waits for the thread below
    publisher.take(block_from(100)); // waits until the stop
  });
  std::optional<RingEntry> first = publisher.ring().take();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->block.first_sample, 0U);
  while (publisher.ring().empty()) {
    std::this_thread::yield();
  }
  stop.request_stop();
  file.join();
  EXPECT_EQ(publisher.ring().take()->block.first_sample, 50U);
  EXPECT_TRUE(publisher.ring().empty());
  EXPECT_EQ(publisher.ring().dropped(), 0U);
}

} // namespace
} // namespace dyncal::inline stream
