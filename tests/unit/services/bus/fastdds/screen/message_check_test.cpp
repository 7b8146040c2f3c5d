#include "services/bus/fastdds/screen/message_check.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;

const Bytes entities{0, 0, 1, 7, 0, 0, 1, 2};

Bytes data(std::uint64_t number) {
  return submessage(0x15, 0x05, u16(0) + u16(16) + entities + sequence(number) + Bytes(8, 0x55));
}

Bytes heartbeat(std::uint64_t last, std::uint32_t count) {
  return submessage(0x07, 0x01, entities + sequence(1) + sequence(last) + u32(count));
}

Bytes announcement(const Bytes& from) {
  const Bytes guid = u16(0x50) + u16(16) + from + Bytes{0, 0, 1, 0xc1};
  return submessage(0x15, 0x05,
                    u16(0) + u16(16) + Bytes(4, 0) + Bytes{0, 1, 0, 0xc2} + sequence(1) +
                        Bytes{0, 3, 0, 0} + guid + u16(1) + u16(0));
}

class MessageCheckTest : public testing::Test {
protected:
  MessageCheck check_;

  void SetUp() override {
    for (const std::uint32_t number : {1, 2}) {
      EXPECT_TRUE(check_.accepts(header() + data(number) + heartbeat(number, number)));
    }
  }
};

TEST_F(MessageCheckTest, RefusesWhatJumps) {
  EXPECT_FALSE(check_.accepts(header() + data(300)));
  EXPECT_FALSE(check_.accepts(header() + data(3) + heartbeat(3, 9000)));
}

TEST_F(MessageCheckTest, LearnsFromAllOfAMessage) {
  EXPECT_FALSE(check_.accepts(header() + data(100) + heartbeat(100, 3)));
  EXPECT_TRUE(check_.accepts(header() + data(101)));
}

TEST_F(MessageCheckTest, HoldsNumbersAgainstTheirSender) {
  const Bytes source = submessage(0x0c, 0x01, u32(0) + Bytes{2, 1, 1, 16} + Bytes(12, 9));
  EXPECT_TRUE(check_.accepts(header() + source + data(300)));
  EXPECT_FALSE(check_.accepts(header() + data(300)));
}

// As the programs of runs come and go for days.
TEST_F(MessageCheckTest, ForgetsWhoIsGoneAndNobodyElse) {
  MessageCheck check;
  MessageCheck::Instant now{};
  std::size_t most = 0;
  for (unsigned char visitor = 1; visitor <= 200; ++visitor) {
    now += std::chrono::seconds(10);
    for (const Bytes& from : {participant, Bytes(12, visitor)}) {
      EXPECT_TRUE(check.accepts(header(from) + announcement(from), now));
      for (const std::uint32_t number : {1, 2}) {
        EXPECT_TRUE(check.accepts(header(from) + data(number) + heartbeat(number, number), now));
      }
    }
    most = std::max(most, check.known_numbers());
  }
  EXPECT_GE(most, 3U * 2U);
  EXPECT_LE(most, 3U * 12U) << "three numbers each, of one that stays and those of 100 s";
  EXPECT_FALSE(check.accepts(header() + data(300), now)) << "it has been there all the time";
  EXPECT_TRUE(check.accepts(header(Bytes(12, 1)) + data(300), now)) << "long gone, a newcomer";
}

// The library wakes its own threads by a byte; what is malformed it counts itself.
TEST_F(MessageCheckTest, LeavesWhatIsNoMessageToTheLibrary) {
  EXPECT_TRUE(check_.accepts(Bytes{0}));
  EXPECT_TRUE(check_.accepts(Bytes(500, 0xff)));
  const Bytes whole = header() + data(3) + heartbeat(3, 3);
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    EXPECT_TRUE(check_.accepts({whole.data(), bytes})) << bytes;
  }
}

} // namespace
} // namespace dyncal::bus
