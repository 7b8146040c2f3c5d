// In which order the sessions of a source come, whatever the clocks of its hosts.
#include "services/records/replay/recording_index.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/mcap/example_recording.hpp"

namespace dyncal::inline records {
namespace {

using testing::ElementsAre;

constexpr std::int64_t hour_ns = 3'600'000'000'000;

class RecordingIndex : public testing::Test {
protected:
  // `clock_ns`: how far the clock of the source's host is ahead of the recorder's.
  void add_block(std::uint64_t session, std::uint64_t block, std::int64_t clock_ns = 0) {
    wire::SampleBlock message;
    message.bench("acc-1");
    message.source("dau");
    message.session(session);
    message.block(block);
    message.received_utc_ns(example_utc_ns + std::int64_t{recording_.sequence} * 1'000'000 +
                            clock_ns);
    recording_.add("DauSamples", message);
  }
  RecordedSource source() {
    EXPECT_TRUE(recording_.writer.close());
    auto reader = recording::RecordingReader::open(folder_.path() / "run.mcap");
    return index_contents(*reader).value().sources.at({"acc-1", "dau"});
  }

  tests::TemporaryFolder folder_;
  ExampleRecording recording_{folder_.path() / "run.mcap"};
};

TEST_F(RecordingIndex, OrdersSessionsAlsoWhereTheClockWasSetBackBetweenThem) {
  add_block(7, 0);
  add_block(7, 1);
  add_block(3, 0, -hour_ns);
  add_block(3, 1, -hour_ns);
  const RecordedSource dau = source();
  EXPECT_THAT(dau.sessions, ElementsAre(7, 3));
  ASSERT_EQ(dau.messages.size(), 4U);
  EXPECT_EQ(dau.messages.begin()->first, (RecordedPosition{0, 0}));
  EXPECT_EQ(dau.position(3, 1), (RecordedPosition{1, 1}));
}

// Who came late had one message of the session that went on, before everything was given again.
TEST_F(RecordingIndex, OrdersSessionsThatWereGivenAgainBehindANewerOne) {
  add_block(3, 40);
  add_block(7, 0);
  add_block(3, 41);
  add_block(7, 1);
  add_block(3, 0);
  add_block(3, 42);
  EXPECT_THAT(source().sessions, ElementsAre(7, 3));
}

TEST_F(RecordingIndex, LeavesASessionInItsPlaceThatIsMendedBehindTheNextOne) {
  add_block(7, 0);
  add_block(3, 0, -hour_ns);
  add_block(7, 1);
  add_block(3, 1, -hour_ns);
  EXPECT_THAT(source().sessions, ElementsAre(7, 3));
}

} // namespace
} // namespace dyncal::inline records
