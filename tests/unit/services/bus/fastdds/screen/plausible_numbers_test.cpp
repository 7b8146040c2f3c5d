#include "services/bus/fastdds/screen/plausible_numbers.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;
namespace format = rtps_format;

constexpr unsigned char little_endian = 0x01;
const Bytes reader{0, 0, 1, 7};
const Bytes writer{0, 0, 1, 2};

class PlausibleNumbersTest : public testing::Test {
protected:
  PlausibleNumbers numbers_;
  PlausibleNumbers::Way way_;

  PlausibleNumbersTest() { std::ranges::copy(participant, way_.from.begin()); }

  bool data(std::uint64_t number, unsigned char id = format::data) {
    return numbers_.accepts(way_, id, little_endian,
                            u16(0) + u16(16) + reader + writer + sequence(number) + Bytes(20, 0));
  }
  bool heartbeat(std::uint64_t first, std::uint64_t last, std::uint32_t count) {
    return numbers_.accepts(way_, format::heartbeat, little_endian,
                            reader + writer + sequence(first) + sequence(last) + u32(count));
  }
  bool gap(std::uint64_t first, std::uint64_t base) {
    return numbers_.accepts(way_, format::gap, little_endian,
                            reader + writer + sequence(first) + sequence(base) + u32(0));
  }
  bool acknack(std::uint64_t base, std::uint32_t count) {
    return numbers_.accepts(way_, format::acknack, little_endian,
                            reader + writer + sequence(base) + u32(32) + u32(0) + u32(count));
  }
  bool nack_frag(std::uint32_t count) {
    return numbers_.accepts(way_, format::nack_frag, little_endian,
                            reader + writer + sequence(1) + u32(1) + u32(32) + u32(0) + u32(count));
  }
  bool heartbeat_frag(std::uint32_t count) {
    return numbers_.accepts(way_, format::heartbeat_frag, little_endian,
                            reader + writer + sequence(1) + u32(4) + u32(count));
  }
};

TEST_F(PlausibleNumbersTest, SamplesGoOnOneByOne) {
  for (const std::uint64_t number : {10, 11, 13, 12, 17}) {
    EXPECT_TRUE(data(number));
  }
  EXPECT_FALSE(data(30)) << "it would take the place of the sample to come";
  EXPECT_FALSE(data(30, format::data_frag));
  EXPECT_TRUE(data(18, format::data_frag));
  EXPECT_TRUE(data(18, format::data_frag)) << "its next fragment";
}

TEST_F(PlausibleNumbersTest, AHeartbeatSaysHowFarSamplesAre) {
  data(10);
  data(11);
  EXPECT_TRUE(heartbeat(1, 120, 1)) << "what is between was lost";
  EXPECT_TRUE(data(121));
  EXPECT_FALSE(heartbeat(1, 2000, 2));
  EXPECT_FALSE(heartbeat(300, 125, 3)) << "its beginning is behind its end";
  EXPECT_TRUE(heartbeat(122, 121, 4)) << "nothing is kept";
}

TEST_F(PlausibleNumbersTest, AnOldHeartbeatSaysNothing) {
  heartbeat(1, 10, 100);
  heartbeat(1, 10, 101);
  data(10);
  EXPECT_TRUE(heartbeat(1, 100, 50));
  EXPECT_FALSE(data(100));
}

TEST_F(PlausibleNumbersTest, CountsDoNotJump) {
  heartbeat(1, 10, 100);
  heartbeat(1, 10, 101);
  EXPECT_FALSE(heartbeat(1, 10, 100'000)) << "all that follow would be taken for old";
  EXPECT_TRUE(heartbeat(1, 10, 102));
  for (const std::uint32_t count : {7, 8}) {
    EXPECT_TRUE(acknack(1, count));
    EXPECT_TRUE(nack_frag(count));
    EXPECT_TRUE(heartbeat_frag(count));
  }
  EXPECT_FALSE(acknack(1, 0x7f000008));
  EXPECT_FALSE(nack_frag(0x7f000008));
  EXPECT_FALSE(heartbeat_frag(0x7f000008));
}

TEST_F(PlausibleNumbersTest, AReaderDoesNotAcknowledgeWhatIsFarAhead) {
  EXPECT_TRUE(acknack(20, 1));
  EXPECT_TRUE(acknack(21, 2));
  EXPECT_FALSE(acknack(70'000, 3));
  EXPECT_FALSE(acknack(70'000, 3)) << "also again";
  EXPECT_TRUE(acknack(1, 0)) << "it begins anew";
}

TEST_F(PlausibleNumbersTest, AGapIsOfKnownSamples) {
  data(10);
  data(11);
  EXPECT_TRUE(gap(3, 12));
  for (int i = 0; i <= GrowingNumber::sure_after; ++i) {
    EXPECT_FALSE(gap(3, 100)) << "its copies come to several sockets";
  }
  EXPECT_TRUE(heartbeat(1, 110, 1));
  EXPECT_TRUE(gap(3, 100));
}

TEST_F(PlausibleNumbersTest, AreThoseThatAWriterCanHave) {
  constexpr std::uint64_t negative = 0xff00'0000'0000'0005;
  EXPECT_FALSE(data(negative));
  EXPECT_FALSE(gap(1, negative));
  EXPECT_FALSE(gap(negative, 1));
  EXPECT_FALSE(heartbeat(1, negative, 1));
  EXPECT_FALSE(heartbeat(negative, negative, 2));
  EXPECT_FALSE(acknack(negative, 1));
}

TEST_F(PlausibleNumbersTest, AreThoseOfOneWriterAndReader) {
  data(10);
  data(11);
  way_.from[0] = 99;
  EXPECT_TRUE(data(5000));
  EXPECT_TRUE(data(5001));
  acknack(1, 500);
  acknack(1, 501);
  way_.to[0] = 4; // a writer of another participant has the same id
  EXPECT_TRUE(acknack(1, 1000));
  EXPECT_TRUE(acknack(1, 1001));
}

// Each packet with a changed sender is one.
TEST_F(PlausibleNumbersTest, NewcomersDoNotMakeItForgetTheKnown) {
  data(10);
  data(11);
  const auto from = way_.from;
  for (std::uint32_t i = 0; i < 2 * PlausibleNumbers::max_newcomers; ++i) {
    std::ranges::copy(u32(i + 1'000'000), way_.from.begin());
    EXPECT_TRUE(data(i));
  }
  way_.from = from;
  EXPECT_FALSE(data(5000));
}

TEST_F(PlausibleNumbersTest, LeavesWhatIsTooShortToOthers) {
  for (const unsigned char id : {format::data, format::data_frag, format::gap, format::heartbeat,
                                 format::heartbeat_frag, format::acknack, format::nack_frag}) {
    for (std::size_t bytes = 0; bytes < 20; ++bytes) {
      EXPECT_TRUE(PlausibleNumbers().accepts(way_, id, little_endian, Bytes(bytes, 0xff)));
    }
  }
}

} // namespace
} // namespace dyncal::bus
