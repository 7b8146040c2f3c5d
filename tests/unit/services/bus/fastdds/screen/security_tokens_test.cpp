#include "services/bus/fastdds/screen/security_tokens.hpp"

#include <gtest/gtest.h>

#include "services/bus/fastdds/screen/message_check.hpp"
#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;
using rtps_format::little_endian_flag;

Bytes counted(const Bytes& bytes) {
  return u32(static_cast<std::uint32_t>(bytes.size())) + bytes +
         Bytes((4 - bytes.size() % 4) % 4, 0);
}

const Bytes name = counted({'c', 'e', 'r', 't', 0});
const Bytes holder = name + u32(1) + name + name + u32(2) + name + counted(Bytes(7, 1)) + name +
                     counted(Bytes(4, 1));

bool is_token(const Bytes& value) {
  return token_is_whole(value, little_endian_flag);
}

Bytes handshake(std::uint32_t holders, const Bytes& rest) {
  return Bytes{0, 1, 0, 0} + Bytes(96, 0) + name + u32(holders) + rest;
}

TEST(SecurityTokens, AreReadToTheirEnd) {
  EXPECT_TRUE(is_token(holder));
  EXPECT_TRUE(is_token(name + u32(0) + u32(0)));
  for (std::size_t bytes = 0; bytes < holder.size(); ++bytes) {
    EXPECT_FALSE(is_token(Bytes(holder.begin(), holder.begin() + static_cast<long>(bytes))));
  }
  EXPECT_TRUE(is_security_token(0x1001));
  EXPECT_FALSE(is_security_token(0x0050));
}

TEST(SecurityTokens, PromiseNoMoreThanThereIs) {
  for (const std::uint32_t count : {0xffffffffU, 0xfffffffdU, 0x80000000U, 0x7fffffffU, 1000U}) {
    EXPECT_FALSE(is_token(u32(count) + holder)) << "bytes of the class";
    EXPECT_FALSE(is_token(name + u32(count) + name + name + u32(0))) << "properties";
    EXPECT_FALSE(is_token(name + u32(0) + u32(count) + name + name)) << "binary properties";
    EXPECT_FALSE(is_token(name + u32(0) + u32(1) + name + u32(count) + Bytes(8, 0))) << "bytes";
    EXPECT_FALSE(handshake_is_whole(handshake(count, holder))) << "holders";
  }
}

TEST(SecurityTokens, OfHandshakesAreReadToo) {
  EXPECT_TRUE(handshake_is_whole(handshake(0, {})));
  EXPECT_TRUE(handshake_is_whole(handshake(2, holder + holder)));
  EXPECT_FALSE(handshake_is_whole(handshake(2, holder)));
  EXPECT_FALSE(handshake_is_whole(Bytes{0, 1, 0, 0}));
  EXPECT_FALSE(handshake_is_whole(Bytes{0, 3, 0, 0} + Bytes(200, 0))) << "a list of parameters";
}

TEST(SecurityTokens, KeepPacketsOffThatCannotBeRead) {
  MessageCheck check;
  const Bytes ends = Bytes(4, 0) + Bytes{0, 2, 1, 0xc3};
  const auto packet = [&](const Bytes& payload) {
    return header() + submessage(0x15, 0x05, u16(0) + u16(16) + ends + sequence(1) + payload);
  };
  EXPECT_TRUE(check.accepts(packet(handshake(1, holder))));
  EXPECT_FALSE(check.accepts(packet(handshake(1000, holder))));
  for (const Bytes& writer : {Bytes{0, 2, 1, 0xc3}, Bytes{0, 1, 0, 0xc2}}) {
    EXPECT_FALSE(check.accepts(header() +
                               submessage(0x16, 0x01,
                                          u16(0) + u16(28) + Bytes(4, 0) + writer + sequence(1) +
                                              u32(1) + u16(1) + u16(64) + u32(64) + Bytes(64, 0))))
        << "in pieces";
  }
}

} // namespace
} // namespace dyncal::bus
