#include "services/stream/stream_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline stream {
namespace {

const std::string bench = "acc";

SourceOptions source_of(SourceKind kind) {
  return {.bench = bench, .source = "x", .kind = kind};
}

RingEntry entry_of(std::uint64_t session, std::uint64_t first_sample) {
  RingEntry entry;
  entry.session = session;
  entry.block.first_sample = first_sample;
  entry.block.samples = 50;
  entry.block.values.assign(50 * 13, 0.25 + static_cast<double>(first_sample));
  return entry;
}

class StreamWriterTest : public testing::Test {
protected:
  StreamWriterTest() {
    network_.lose([this](const bus::MessageInTransit& message) {
      sent_.push_back(message.payload.data());
      return false;
    });
  }
  std::unique_ptr<StreamWriter> writer(SourceKind kind) {
    return StreamWriter::create(sending_, source_of(kind)).value();
  }
  std::size_t write_and_keep(StreamWriter& writer, RingEntry entry) {
    writer.prepare(std::move(entry), "");
    EXPECT_EQ(writer.write(std::chrono::nanoseconds(0)), bus::WriteOutcome::written);
    return writer.keep_in(*kept_);
  }

  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant sending_ = network_.join("source");
  bus::Participant reading_ = network_.join("analysis");
  std::shared_ptr<RetransmissionBuffer> kept_ =
      std::make_shared<RetransmissionBuffer>(KeptLimits{});
  std::vector<const char*> sent_; // where in memory the bytes were
};

TEST_F(StreamWriterTest, KeepsTheVeryBytesThatItSends) {
  auto reader = reading_.reader(bus::topics::acs_samples, bench, nullptr).value();
  const auto blocks = writer(SourceKind::acs);
  for (std::uint64_t i = 0; i < 3; ++i) {
    const std::size_t bytes = write_and_keep(*blocks, entry_of(7, 50 * i));
    const auto found = kept_->at_or_behind(i);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->number, i);
    EXPECT_EQ(found->payload->size(), bytes);
    ASSERT_EQ(sent_.size(), i + 1);
    EXPECT_EQ(found->payload->data(), sent_.back()) << "encoded or copied once more";
  }
  std::vector<wire::SampleBlock> read;
  reader.take([&](const wire::SampleBlock& block) { read.push_back(block); });
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[2].block(), 2U);
  EXPECT_EQ(read[2].first_sample(), 100U);
  EXPECT_EQ(read[2].values(), std::vector<double>(50 * 13, 100.25));
}

TEST_F(StreamWriterTest, KeepsTheVeryBytesOfARecord) {
  auto reader = reading_.reader(bus::topics::dso_record, bench, nullptr).value();
  const auto records = writer(SourceKind::dso);
  RingEntry entry = entry_of(7, 0);
  entry.shot = Shot{.number = 4, .run = "R1", .step = 2};
  write_and_keep(*records, std::move(entry));
  const auto found = kept_->at_or_behind(0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->number, 4U);
  ASSERT_EQ(sent_.size(), 1U);
  EXPECT_EQ(found->payload->data(), sent_.front());
}

// A message that finds no room stays as it is and is tried again.
TEST_F(StreamWriterTest, WritesTheSameBytesWhenItTriesAgain) {
  auto reader = reading_.reader(bus::topics::acs_samples, bench, nullptr).value();
  const auto blocks = writer(SourceKind::acs);
  network_.fill_writers(bus::topics::acs_samples.name);
  blocks->prepare(entry_of(7, 0), "run-1");
  EXPECT_EQ(blocks->write(std::chrono::nanoseconds(0)), bus::WriteOutcome::timed_out);
  network_.empty_writers(bus::topics::acs_samples.name);
  EXPECT_EQ(blocks->write(std::chrono::nanoseconds(0)), bus::WriteOutcome::written);
  EXPECT_GT(blocks->keep_in(*kept_), 0U);
  ASSERT_EQ(sent_.size(), 1U);
  EXPECT_EQ(kept_->at_or_behind(0)->payload->data(), sent_.front());
  EXPECT_EQ(kept_->place_behind(0, 0, "run-1"), 0U); // it answers that run
}

} // namespace
} // namespace dyncal::inline stream
