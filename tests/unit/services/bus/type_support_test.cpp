#include "services/bus/type_support.hpp"

#include <gtest/gtest.h>

#include "services/bus/cdr_key.hpp"

namespace dyncal::bus {
namespace {

template <class T>
std::string bytes_of(const T& sample) {
  const TypeSupport& type = type_support<T>();
  std::string bytes(type.serialized_size(&sample), '\0');
  bytes.resize(type.serialize(&sample, bytes.data(), bytes.size()));
  return bytes;
}

template <class T>
bool read(T& sample, const std::string& bytes) {
  return type_support<T>().deserialize(&sample, bytes.data(), bytes.size());
}

wire::SampleBlock example_block() {
  wire::SampleBlock block;
  block.bench("acc-1");
  block.source("dau");
  block.session(0x0123456789abcdefU);
  block.block(3);
  block.first_sample(150);
  block.sample_count(2);
  block.channel_count(2);
  block.acknowledged_run("run-1");
  block.stamps_ns({1'500'000'000'000'000'001, 1'500'000'000'001'000'002});
  block.stamp_uncertainty_ns({100, 101});
  block.stamp_flags({0, 4});
  block.values({0.1, -0.2, 1e300, 5e-324});
  block.received_utc_ns(-1);
  return block;
}

TEST(TypeSupport, ReadsWhatItWrites) {
  const wire::SampleBlock written = example_block();
  wire::SampleBlock read_back;
  ASSERT_TRUE(read(read_back, bytes_of(written)));
  EXPECT_EQ(read_back, written);
}

TEST(TypeSupport, ReadsIntoASampleThatHeldAnother) {
  wire::SampleBlock sample = example_block();
  wire::SampleBlock empty;
  empty.bench("b");
  ASSERT_TRUE(read(sample, bytes_of(empty)));
  EXPECT_EQ(sample, empty);
}

TEST(TypeSupport, ReadsAMessageOfAnOlderTypeWithZerosForTheMissingMembers) {
  const wire::SampleBlock written = example_block();
  const std::string bytes = bytes_of(written);
  wire::SampleBlock read_back;
  ASSERT_TRUE(read(
      read_back, bytes.substr(0, bytes.size() - sizeof(std::int64_t)))); // without received_utc_ns
  wire::SampleBlock expected = written;
  expected.received_utc_ns(0);
  EXPECT_EQ(read_back, expected);
}

TEST(TypeSupport, LeavesMembersOfANewerTypeUnread) {
  wire::SampleBlock read_back;
  ASSERT_TRUE(
      read(read_back, bytes_of(example_block()) + std::string("more of it, by a later version")));
  EXPECT_EQ(read_back, example_block());
}

// Cut inside a member, it is not an older type: samples must not be made up of zeros.
TEST(TypeSupport, RefusesAMessageThatIsCutInsideAMember) {
  const std::string bytes = bytes_of(example_block());
  wire::SampleBlock sample;
  EXPECT_FALSE(read(sample, bytes.substr(0, bytes.size() - 4))); // in received_utc_ns
  EXPECT_FALSE(read(sample, bytes.substr(0, bytes.size() - 8 - 3 * sizeof(double)))); // in values
  EXPECT_FALSE(read(sample, bytes.substr(0, cdr_header_bytes + 6)));                  // in bench
  EXPECT_FALSE(read(sample, ""));
}

TEST(TypeSupport, SurvivesAnyBytesAndReadsTheIntactOnesAfterwards) {
  const std::string bytes = bytes_of(example_block());
  wire::SampleBlock sample;
  for (std::size_t i = cdr_header_bytes; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0xFF);
    (void)read(sample, damaged);
  }
  for (std::size_t count = 0; count < bytes.size(); ++count) {
    (void)read(sample, bytes.substr(0, count));
  }
  ASSERT_TRUE(read(sample, bytes));
  EXPECT_EQ(sample, example_block());
}

template <class T>
class EveryType : public testing::Test {};
using Types = testing::Types<wire::SourceDescription, wire::SourceStatus, wire::SampleBlock,
                             wire::TriggeredRecord, wire::Measurement, wire::Excitation,
                             wire::CalibrationResult, wire::TransferFunction,
                             wire::SampleClockReport, wire::ServiceStatus, wire::Command,
                             wire::CatchUpRequest, wire::ClockRequest, wire::ClockAnswer>;
TYPED_TEST_SUITE(EveryType, Types);

TYPED_TEST(EveryType, IsNamedAsInTheContract) {
  EXPECT_EQ(type_support<TypeParam>().name.substr(0, 8), "dyncal::");
}

TYPED_TEST(EveryType, HasItsKeyWhereTheLayoutSays) {
  const TypeSupport& type = type_support<TypeParam>();
  const TypeParam sample;
  const std::string whole = bytes_of(sample);
  std::string key_only(max_key_payload_bytes, '\0');
  key_only.resize(type.serialize_key(&sample, key_only.data(), key_only.size()));
  ASSERT_GT(key_only.size(), cdr_header_bytes);
  const auto key = read_key(type.key, whole.data(), whole.size());
  ASSERT_TRUE(key);
  EXPECT_EQ(read_key(type.key, key_only.data(), key_only.size()), key);
  EXPECT_EQ(key_payload(*key, ByteOrder::little).size(), key_only.size());
}

TYPED_TEST(EveryType, WritesTheKeyThatIsHashedAsItIsReadFromAMessage) {
  const TypeSupport& type = type_support<TypeParam>();
  Key key;
  for (std::size_t i = 0; i < type.key.string_bounds.size(); ++i) {
    key.strings.emplace_back(1 + 5 * i, static_cast<char>('a' + i)); // every alignment of the next
  }
  for (std::size_t i = 0; i < type.key.numbers; ++i) {
    key.numbers.push_back(static_cast<std::uint32_t>(0x01020304 + i));
  }
  TypeParam sample;
  ASSERT_TRUE(read(sample, key_payload(key, ByteOrder::little)));
  std::string canonical(max_key_payload_bytes, '\xFF'); // padding must be written as zeros
  canonical.resize(type.canonical_key(&sample, canonical.data(), canonical.size()));
  EXPECT_EQ(canonical, canonical_key(key));
  EXPECT_EQ(type.canonical_key(&sample, canonical.data(), canonical.size() - 1), 0U);
}

TYPED_TEST(EveryType, AllowsItsLongestKeyAndHasAlwaysTheHashOfAKeyOver16Bytes) {
  const KeyLayout& layout = type_support<TypeParam>().key;
  Key longest;
  for (const std::size_t bound : layout.string_bounds) {
    longest.strings.emplace_back(bound, 'k');
  }
  longest.numbers.assign(layout.numbers, 0);
  const std::string payload = key_payload(longest, ByteOrder::little);
  EXPECT_LE(payload.size(), max_key_payload_bytes);
  EXPECT_GT(TypeParam::getKeyMaxCdrSerializedSize(), 16U);
  EXPECT_GE(TypeParam::getKeyMaxCdrSerializedSize() + cdr_header_bytes + 8, payload.size());
  EXPECT_LE(TypeParam::getKeyMaxCdrSerializedSize(), payload.size() + cdr_header_bytes * 4);
}

TYPED_TEST(EveryType, IsShorterThanTheZerosThatStandForMissingMembers) {
  EXPECT_LT(bytes_of(TypeParam{}).size(), 1000U);
}

} // namespace
} // namespace dyncal::bus
