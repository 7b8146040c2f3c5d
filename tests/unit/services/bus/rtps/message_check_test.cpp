#include "services/bus/rtps/message_check.hpp"

#include <gtest/gtest.h>

#include "tests/unit/services/bus/rtps/rtps_bytes.hpp"

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
