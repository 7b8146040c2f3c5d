#include "services/bus/type_support.hpp"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include "services/bus/cdr_key.hpp"
#include "services/bus/payload_checksum.hpp"
#include "services/bus/type_support_of.hpp"

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

// As contract 2 had it.
struct OlderExcitation : wire::Excitation {
  template <class Message, class Visit>
  static void visit_members(Message& message, Visit&& visit) {
    visit(message.bench());
    visit(message.run());
    visit(message.step());
    visit(message.frequency_text_hz());
    visit(message.level_m_s2());
    visit(message.repetition());
    visit(message.state());
    visit(message.window_begin_utc_ns());
    visit(message.window_end_utc_ns());
    visit(message.attempt());
    visit(message.repeated_steps());
    visit(message.checksum());
  }
};

TEST(TypeSupport, HoldsAMessageOfContract2AgainstItsChecksum) {
  for (std::uint32_t repeated = 0; repeated < 3; ++repeated) { // the next member is aligned to 8
    OlderExcitation older;
    older.bench("acc-1");
    older.run("run-1");
    older.step(3);
    older.repeated_steps().resize(repeated, 2);
    std::string bytes(Encoder<OlderExcitation>::serialized_size(&older), '\0');
    Encoder<OlderExcitation>::serialize(&older, bytes.data(), bytes.size());
    wire::Excitation excitation;
    ASSERT_TRUE(read(excitation, bytes));
    EXPECT_EQ(excitation, static_cast<const wire::Excitation&>(older));
    // A length that is one more makes a message of it that ends before the checksum, as one of
    // contract 1 does.
    std::size_t accepted = 0;
    for (std::size_t at = cdr_header_bytes; at < bytes.size(); ++at) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ 1);
      accepted += read(excitation, changed) ? 1 : 0;
    }
    EXPECT_LE(accepted, 1U);
  }
}

TEST(TypeSupport, ReadsIntoASampleThatHeldAnother) {
  wire::SampleBlock sample = example_block();
  wire::SampleBlock empty;
  empty.bench("b");
  ASSERT_TRUE(read(sample, bytes_of(empty)));
  EXPECT_EQ(sample, empty);
}

TEST(TypeSupport, ReadsAMessageOfTheFirstReleaseWhichHasNoChecksum) {
  const std::string bytes = bytes_of(example_block());
  wire::SampleBlock read_back;
  ASSERT_TRUE(read(read_back, bytes.substr(0, bytes.size() - checksum_bytes)));
  EXPECT_EQ(read_back, example_block());
}

TEST(TypeSupport, RefusesAMessageThatLacksMembersOfTheFirstRelease) {
  const std::string bytes = bytes_of(example_block());
  wire::SampleBlock sample; // and received_utc_ns
  EXPECT_FALSE(read(sample, bytes.substr(0, bytes.size() - checksum_bytes - sizeof(std::int64_t))));
}

TEST(TypeSupport, LeavesAMessageUncheckedWhoseWriterGivesNoChecksum) {
  std::string bytes = bytes_of(example_block());
  bytes.replace(bytes.size() - checksum_bytes, checksum_bytes, checksum_bytes, '\0');
  wire::SampleBlock read_back;
  ASSERT_TRUE(read(read_back, bytes));
  EXPECT_EQ(read_back, example_block());
}

// As a foreign program writes it that takes zlib at its word.
TEST(TypeSupport, HasTheChecksumOfTheContractsPage) {
  const std::string bytes = bytes_of(example_block());
  const std::size_t at = bytes.size() - checksum_bytes;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(at));
  std::uint32_t given = 0;
  std::memcpy(&given, bytes.data() + at, sizeof given);
  EXPECT_EQ(given, sum);
}

TEST(TypeSupport, RefusesAMessageOfWhichAnyByteWasChanged) {
  const std::string bytes = bytes_of(example_block());
  wire::SampleBlock sample;
  std::size_t tried = 0;
  for (std::size_t i = cdr_header_bytes; i < bytes.size(); ++i) {
    for (const unsigned change : {0x01U, 0x80U, 0xFFU}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(static_cast<unsigned char>(damaged[i]) ^ change);
      EXPECT_FALSE(read(sample, damaged)) << "byte " << i;
      ++tried;
    }
  }
  EXPECT_GT(tried, 300U);
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
  const std::size_t count = bytes.size() - checksum_bytes;
  EXPECT_FALSE(read(sample, bytes.substr(0, count - 4)));                      // received_utc_ns
  EXPECT_FALSE(read(sample, bytes.substr(0, count - 8 - 3 * sizeof(double)))); // in values
  EXPECT_FALSE(read(sample, bytes.substr(0, cdr_header_bytes + 6)));           // in bench
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

// Bytes before the count of a plan's steps.
std::size_t bytes_before_steps() {
  wire::Measurement one;
  one.steps().resize(1);
  const std::string without = bytes_of(wire::Measurement());
  const std::string with_one = bytes_of(one);
  const auto differs = std::mismatch(without.begin(), without.end(), with_one.begin());
  return static_cast<std::size_t>(differs.first - without.begin());
}

// A plan whose count says that every byte behind it is a step.
std::string plan_of_as_many_steps_as_bytes(std::size_t steps) {
  std::string bytes = bytes_of(wire::Measurement()).substr(0, bytes_before_steps());
  const auto count = static_cast<std::uint32_t>(steps);
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count); // NOLINT: as CDR has it
  bytes.append(steps, '\0');
  return bytes;
}

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) << 10U;
}

TEST(TypeSupport, MakesNoRoomForWhatACountAloneSays) {
  constexpr std::size_t little = std::size_t{48} << 20U;
  wire::Measurement measurement;
  const std::string bytes = plan_of_as_many_steps_as_bytes(1'000'000);
  const std::size_t before = peak_memory_bytes();
  EXPECT_FALSE(read(measurement, bytes));
  EXPECT_LT(peak_memory_bytes() - before, little);
}

TEST(TypeSupport, ReadsALongMessageWithAndWithoutItsChecksum) {
  wire::Measurement plan;
  plan.steps().resize(20'000);
  const std::string bytes = bytes_of(plan);
  wire::Measurement read_plan;
  ASSERT_TRUE(read(read_plan, bytes));
  EXPECT_EQ(read_plan, plan);
  ASSERT_TRUE(read(read_plan, bytes.substr(0, bytes.size() - checksum_bytes)));
  EXPECT_EQ(read_plan, plan);
}

TEST(TypeSupport, ReadsALongMessageOfANewerTypeWhichEndsWithAChecksumOfItsOwn) {
  wire::Measurement plan;
  plan.steps().resize(20'000);
  std::string bytes = bytes_of(plan);
  bytes.replace(bytes.size() - checksum_bytes, checksum_bytes, checksum_bytes, '\0');
  bytes += std::string("more of it, by a later ver") + std::string(2 + checksum_bytes, '\0');
  set_checksum(bytes.data(), bytes.size());
  wire::Measurement read_plan;
  ASSERT_TRUE(read(read_plan, bytes));
  EXPECT_EQ(read_plan, plan);
}

template <class T>
class EveryType : public testing::Test {};
using Types =
    testing::Types<wire::SourceDescription, wire::SourceStatus, wire::SampleBlock,
                   wire::TriggeredRecord, wire::Measurement, wire::Excitation,
                   wire::CalibrationResult, wire::TransferFunction, wire::SampleClockReport,
                   wire::ServiceStatus, wire::Command, wire::CatchUpRequest, wire::ClockRequest,
                   wire::ClockAnswer, wire::LinkProbe, wire::LinkEcho>;
TYPED_TEST_SUITE(EveryType, Types);

TYPED_TEST(EveryType, IsNamedAsInTheContract) {
  EXPECT_EQ(type_support<TypeParam>().name.substr(0, 8), "dyncal::");
}

TYPED_TEST(EveryType, HasItsKeyWhereTheLayoutSays) {
  const TypeSupport& type = type_support<TypeParam>();
  Key key;
  for (std::size_t i = 0; i < type.key.string_bounds.size(); ++i) {
    key.strings.emplace_back(1 + 5 * i, static_cast<char>('a' + i)); // every alignment of the next
  }
  for (std::size_t i = 0; i < type.key.numbers; ++i) {
    key.numbers.push_back(static_cast<std::uint32_t>(0x01020304 + i));
  }
  TypeParam sample;
  (void)read(sample, key_payload(key, ByteOrder::little)); // as far as it goes
  const std::string whole = bytes_of(sample);
  EXPECT_EQ(read_key(type.key, whole.data(), whole.size()), key);
}

TYPED_TEST(EveryType, IsKeptAsItCameOnlyIfItIsWholeAndHasAChecksum) {
  const TypeSupport& type = type_support<TypeParam>();
  TypeParam sample;
  const EncodedMessage whole = encode(sample);
  ASSERT_TRUE(whole);
  ASSERT_TRUE(read(sample, *whole));
  EXPECT_TRUE(is_whole(type, &sample, *whole));
  EXPECT_EQ(bytes_of(sample), *whole);

  std::string unsealed = *whole;
  unsealed.replace(unsealed.size() - checksum_bytes, checksum_bytes, checksum_bytes, '\0');
  ASSERT_TRUE(read(sample, unsealed));
  EXPECT_FALSE(is_whole(type, &sample, unsealed));
  EXPECT_FALSE(is_whole(type, &sample, whole->substr(0, whole->size() - checksum_bytes))); // older
  EXPECT_FALSE(is_whole(type, &sample, *whole + "more"));                                  // newer
  std::string big_endian = *whole;
  big_endian[1] = 0;
  EXPECT_FALSE(is_whole(type, &sample, big_endian));
}

TYPED_TEST(EveryType, AllowsItsLongestKeyAndHasAlwaysTheHashOfAKeyOver16Bytes) {
  const KeyLayout& layout = type_support<TypeParam>().key;
  Key longest;
  Key longer;
  for (const std::size_t bound : layout.string_bounds) {
    longest.strings.emplace_back(bound, 'k');
    longer.strings.emplace_back(bound + 1, 'k');
  }
  longest.numbers.assign(layout.numbers, 0);
  longer.numbers = longest.numbers;
  const std::string payload = key_payload(longest, ByteOrder::little);
  EXPECT_LE(payload.size(), max_key_payload_bytes);
  EXPECT_GT(payload.size(), cdr_header_bytes + 16U);
  for (const Key& key : {longest, longer}) { // the type has the bounds of the layout
    TypeParam sample;
    (void)read(sample, key_payload(key, ByteOrder::little)); // as far as it goes
    const std::string whole = bytes_of(sample);
    EXPECT_EQ(read_key(layout, whole.data(), whole.size()), longest);
  }
}

TYPED_TEST(EveryType, IsReadWithoutItsChecksumButRefusedWithAWrongOne) {
  TypeParam sample;
  const std::string bytes = bytes_of(sample);
  ASSERT_TRUE(read(sample, bytes));
  EXPECT_EQ(sample.checksum(), 0U);
  EXPECT_TRUE(read(sample, bytes.substr(0, bytes.size() - checksum_bytes)));
  std::string damaged = bytes;
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  EXPECT_FALSE(read(sample, damaged));
}

} // namespace
} // namespace dyncal::bus
