#include "services/bus/fastdds/screen/acknack_rewriter.hpp"

#include <gtest/gtest.h>

#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;

const Bytes entities{0, 0, 1, 7, 0, 0, 1, 2};

class AcknackRewriterTest : public testing::Test {
protected:
  AcknackRewriter acknacks_;

  void expect_rewritten(const Bytes& message, const Bytes& expected) {
    Bytes datagram = header() + message;
    acknacks_.rewrite_all(datagram);
    EXPECT_EQ(datagram, header() + expected);
  }
};

Bytes acknack(unsigned char flags, std::uint64_t base, std::uint32_t count) {
  return submessage(0x06, flags, entities + sequence(base) + u32(0) + u32(count));
}

TEST_F(AcknackRewriterTest, MakesAReaderThatBeginsAnewOneThatFastDdsTakesNoticeOf) {
  expect_rewritten(acknack(0x03, 1, 0), acknack(0x03, 1, 0)); // asks for no answer: not that
  expect_rewritten(acknack(0x01, 1, 0), acknack(0x01, 0, 1)); // as Cyclone DDS begins anew
  expect_rewritten(acknack(0x01, 9, 40), acknack(0x01, 9, 41));
  expect_rewritten(acknack(0x01, 1, 0), acknack(0x01, 1, 1)); // a copy, which Fast DDS passes over
}

TEST_F(AcknackRewriterTest, ReadsBigEndian) {
  const Bytes head{0x06, 0x00, 0, 24};
  expect_rewritten(head + entities + Bytes{0, 0, 0, 0, 0, 0, 0, 1} + Bytes(8, 0),
                   head + entities + Bytes(15, 0) + Bytes{1});
}

// As one in Fast DDS does that has forgotten its writer and heard a heartbeat before it said so.
TEST_F(AcknackRewriterTest, MakesAReaderThatAsksForWhatItHadOneThatBeginsAnew) {
  const auto asking = [](std::uint64_t base, std::uint32_t count) {
    return submessage(0x06, 0x01,
                      entities + sequence(base) + u32(9) + u32(0xff800000) + u32(count));
  };
  expect_rewritten(acknack(0x03, 12, 5), acknack(0x03, 12, 5));
  expect_rewritten(asking(1, 6),
                   submessage(0x06, 0x01, entities + sequence(0) + u32(0) + u32(6) + u32(6)));
  expect_rewritten(asking(1, 7), asking(1, 7));
}

TEST_F(AcknackRewriterTest, RewritesEachOfAMessageAndNothingElse) {
  const Bytes other{0, 0, 2, 7, 0, 0, 1, 2};
  const Bytes heartbeat = submessage(0x07, 0x01, Bytes(28, 1));
  const Bytes of_other = submessage(0x06, 0x01, other + sequence(1) + u32(0) + u32(0));
  expect_rewritten(acknack(0x01, 1, 0) + heartbeat + of_other,
                   acknack(0x01, 0, 1) + heartbeat +
                       submessage(0x06, 0x01, other + sequence(0) + u32(0) + u32(1)));
}

TEST_F(AcknackRewriterTest, LeavesWhatIsNotAsItShouldBe) {
  const Bytes cut = submessage(0x06, 0x01, entities + sequence(1) + u32(0));
  expect_rewritten(cut, cut);
  const Bytes long_list = submessage(0x06, 0x01, entities + sequence(1) + u32(257) + u32(0));
  expect_rewritten(long_list, long_list);
  const Bytes too_long{0x06, 0x01, 200, 0, 1, 2, 3, 4};
  expect_rewritten(too_long, too_long);
  Bytes no_header{'R', 'T', 'P'};
  acknacks_.rewrite_all(no_header);
  EXPECT_EQ(no_header, (Bytes{'R', 'T', 'P'}));
}

} // namespace
} // namespace dyncal::bus
