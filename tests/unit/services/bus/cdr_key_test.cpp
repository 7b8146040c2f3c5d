#include "services/bus/cdr_key.hpp"

#include <gtest/gtest.h>

#include "services/bus/type_support.hpp"

namespace dyncal::bus {
namespace {

const KeyLayout bench_and_step{{64}, 1};

// "acc" and 258, by hand.
const std::string little_endian("\0\1\0\0"
                                "\4\0\0\0acc\0"
                                "\2\1\0\0",
                                16);
const std::string big_endian("\0\0\0\0"
                             "\0\0\0\4acc\0"
                             "\0\0\1\2",
                             16);

std::string payload_with_length(std::uint32_t length, std::size_t characters) {
  std::string bytes("\0\1\0\0", 4);
  bytes.append(reinterpret_cast<const char*>(&length), sizeof length);
  return bytes.append(characters, 'x').append(64, '\0');
}

TEST(CdrKey, ReadsBothByteOrders) {
  const Key expected{{"acc"}, {258}};
  EXPECT_EQ(read_key(bench_and_step, little_endian.data(), little_endian.size()), expected);
  EXPECT_EQ(read_key(bench_and_step, big_endian.data(), big_endian.size()), expected);
}

TEST(CdrKey, WritesWhatItReads) {
  const Key key{{"acc"}, {258}};
  EXPECT_EQ(key_payload(key, ByteOrder::little), little_endian);
  EXPECT_EQ(key_payload(key, ByteOrder::big), big_endian);
  EXPECT_EQ(canonical_key(key), big_endian.substr(cdr_header_bytes));
}

TEST(CdrKey, AlignsNumbersWithZeros) {
  const std::string canonical = canonical_key(Key{{"a"}, {1}});
  EXPECT_EQ(canonical, std::string("\0\0\0\2a\0\0\0\0\0\0\1", 12));
}

TEST(CdrKey, AcceptsAStringOfItsBoundAndRefusesALongerOne) {
  const KeyLayout layout{{64}, 0};
  const std::string fits = payload_with_length(65, 64);
  const std::string too_long = payload_with_length(66, 65);
  ASSERT_TRUE(read_key(layout, fits.data(), fits.size()));
  EXPECT_EQ(read_key(layout, fits.data(), fits.size())->strings.front().size(), 64U);
  EXPECT_FALSE(read_key(layout, too_long.data(), too_long.size()));
}

TEST(CdrKey, RefusesWhatEndsTooSoonOrIsNoPlainCdr) {
  for (std::size_t count = 0; count < little_endian.size(); ++count) {
    EXPECT_FALSE(read_key(bench_and_step, little_endian.data(), count)) << count;
  }
  for (const char representation : {'\2', '\3', '\6', '\7', '\11'}) { // parameter lists and XCDR2
    std::string other = little_endian;
    other[1] = representation;
    EXPECT_FALSE(read_key(bench_and_step, other.data(), other.size()));
  }
  const std::string no_end =
      payload_with_length(4, 60); // the character where the closing zero belongs is an x
  EXPECT_FALSE(read_key(KeyLayout{{64}, 0}, no_end.data(), no_end.size()));
  const std::string huge = payload_with_length(0xFFFFFFFFU, 60);
  EXPECT_FALSE(read_key(KeyLayout{{64}, 0}, huge.data(), huge.size()));
}

} // namespace
} // namespace dyncal::bus
