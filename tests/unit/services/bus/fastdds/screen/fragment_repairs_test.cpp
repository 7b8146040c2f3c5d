#include "services/bus/fastdds/screen/fragment_repairs.hpp"

#include <gtest/gtest.h>

#include "services/bus/fastdds/screen/rtps_format.hpp"
#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;
using std::chrono::milliseconds;

Bytes fragment(std::uint32_t number, std::uint64_t sample = 5, unsigned char writer = 1,
               unsigned char reader = 0) {
  return submessage(rtps_format::data_frag, rtps_format::little_endian_flag,
                    u16(0) + u16(28) + Bytes{0, 0, 0, reader, 0, 0, writer, 2} + sequence(sample) +
                        u32(number) + u16(1) + u16(100) + u32(250) + Bytes(100, 0xdd));
}

// The repair of fragment 1 for a reader of a participant.
Bytes repair(unsigned char participant, unsigned char reader) {
  return submessage(rtps_format::info_destination, rtps_format::little_endian_flag,
                    Bytes(rtps_format::prefix_bytes, participant)) +
         fragment(1, 5, 1, reader);
}

Bytes stamped(const Bytes& submessages) {
  return header() +
         submessage(rtps_format::info_timestamp, rtps_format::little_endian_flag, Bytes(8)) +
         submessages + submessage(0x80, rtps_format::little_endian_flag, Bytes(56));
}

class FragmentRepairsTest : public testing::Test {
protected:
  bool went_lately(const Bytes& submessages, std::size_t destination = 1) {
    return repairs_.went_lately(stamped(submessages), destination, now_);
  }

  FragmentRepairs repairs_;
  FragmentRepairs::Instant now_{std::chrono::hours(1)};
};

TEST_F(FragmentRepairsTest, LetsAFragmentGoOncePerIntervalWhichGrows) {
  EXPECT_FALSE(went_lately(fragment(1)));
  EXPECT_TRUE(went_lately(fragment(1)));
  now_ += FragmentRepairs::min_interval - milliseconds(1);
  EXPECT_TRUE(went_lately(fragment(1)));
  now_ += milliseconds(1);
  EXPECT_FALSE(went_lately(fragment(1)));
  for (auto interval = 2 * FragmentRepairs::min_interval;
       interval < 2 * FragmentRepairs::max_interval; interval *= 2) {
    now_ += interval - milliseconds(1);
    EXPECT_TRUE(went_lately(fragment(1))) << interval.count();
    now_ += milliseconds(1);
    EXPECT_FALSE(went_lately(fragment(1))) << interval.count();
  }
  now_ += FragmentRepairs::max_interval; // forgotten
  EXPECT_FALSE(went_lately(fragment(1)));
  now_ += FragmentRepairs::min_interval;
  EXPECT_FALSE(went_lately(fragment(1)));
}

TEST_F(FragmentRepairsTest, TellsFragmentsSamplesWritersAndDestinationsApart) {
  EXPECT_FALSE(went_lately(fragment(1)));
  EXPECT_FALSE(went_lately(fragment(2)));
  EXPECT_FALSE(went_lately(fragment(1, 6)));
  EXPECT_FALSE(went_lately(fragment(1, 5, 3)));
  EXPECT_FALSE(went_lately(fragment(1), 2));
}

TEST_F(FragmentRepairsTest, CountsWhatWentToAllForEveryReader) {
  EXPECT_FALSE(went_lately(fragment(1)));
  EXPECT_TRUE(went_lately(repair(1, 7)));
  now_ += FragmentRepairs::min_interval;
  EXPECT_FALSE(went_lately(repair(1, 7)));
  now_ += 2 * FragmentRepairs::min_interval - milliseconds(1);
  EXPECT_TRUE(went_lately(repair(1, 7)));
  now_ += milliseconds(1);
  EXPECT_FALSE(went_lately(repair(1, 7)));
}

// One participant has several readers of a topic, and programs follow each other on one port.
TEST_F(FragmentRepairsTest, LetsNoReaderWaitForTheRepairsOfAnother) {
  for (auto interval = FragmentRepairs::min_interval; interval < FragmentRepairs::max_interval;
       interval *= 2) {
    EXPECT_FALSE(went_lately(repair(1, 7)));
    now_ += interval;
  }
  EXPECT_FALSE(went_lately(repair(1, 7)));
  EXPECT_TRUE(went_lately(repair(1, 7)));
  EXPECT_FALSE(went_lately(repair(1, 8)));
  EXPECT_FALSE(went_lately(repair(2, 7)));
}

TEST_F(FragmentRepairsTest, LetsADatagramGoThatCarriesAnythingElse) {
  const Bytes heartbeat =
      submessage(rtps_format::heartbeat, rtps_format::little_endian_flag, Bytes(28));
  EXPECT_FALSE(went_lately(fragment(1) + heartbeat));
  EXPECT_FALSE(went_lately(fragment(1) + heartbeat));
  EXPECT_FALSE(went_lately(heartbeat));
  EXPECT_FALSE(went_lately({}));
  EXPECT_FALSE(went_lately(fragment(1) + fragment(2))); // the second did not go yet
  EXPECT_TRUE(went_lately(fragment(1) + fragment(2)));
}

TEST_F(FragmentRepairsTest, PassesOnWhatIsTooShortToTell) {
  const Bytes cut = submessage(rtps_format::data_frag, rtps_format::little_endian_flag, Bytes(23));
  EXPECT_FALSE(went_lately(cut));
  EXPECT_FALSE(went_lately(cut));
}

TEST_F(FragmentRepairsTest, ForgetsTheOldestBeyondItsBound) {
  for (std::uint32_t number = 0; number < FragmentRepairs::max_fragments + 2; ++number) {
    EXPECT_FALSE(went_lately(fragment(number)));
  }
  EXPECT_FALSE(went_lately(fragment(0)));
  EXPECT_TRUE(went_lately(fragment(FragmentRepairs::max_fragments)));
}

} // namespace
} // namespace dyncal::bus
