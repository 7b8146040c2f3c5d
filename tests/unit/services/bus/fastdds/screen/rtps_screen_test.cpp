#include "services/bus/fastdds/screen/rtps_screen.hpp"

#include <string>

#include <gtest/gtest.h>

#include "services/bus/qos_profiles.hpp"
#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;

const Bytes entities{0, 0, 1, 7, 0, 0, 1, 2};

Bytes key_hash() {
  return u16(0x70) + u16(16) + Bytes(16, 0xaa);
}

const Bytes sentinel = u16(1) + u16(0);

struct Fragments {
  std::uint32_t first = 1;
  unsigned count = 1;
  unsigned fragment_bytes = 100;
  std::uint32_t sample_bytes = 250;
  std::size_t payload = 100;
  Bytes qos = key_hash() + sentinel;
};

Bytes fragments(const Fragments& of) {
  return submessage(0x16, of.qos.empty() ? 0x01 : 0x03,
                    u16(0) + u16(28) + entities + sequence(5) + u32(of.first) + u16(of.count) +
                        u16(of.fragment_bytes) + u32(of.sample_bytes) + of.qos +
                        Bytes(of.payload, 0x55));
}

Bytes data(const Bytes& qos, unsigned char flags = 0x07) {
  return submessage(0x15, flags, u16(0) + u16(16) + entities + sequence(5) + qos + Bytes(8, 0x55));
}

Bytes heartbeat() {
  return submessage(0x07, 0x01, entities + sequence(1) + sequence(5) + u32(3));
}

Bytes gap(std::uint64_t first, std::uint64_t base, std::uint32_t bits, const Bytes& words) {
  return submessage(0x08, 0x01, entities + sequence(first) + sequence(base) + u32(bits) + words);
}

Bytes passed(const Bytes& datagram) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen screen(stamps, progress);
  const auto bytes = screen.pass(datagram);
  return {bytes.begin(), bytes.end()};
}

const Bytes stamp = submessage(0x09, 0x01, sequence(77));

TEST(RtpsScreen, LeavesWholeMessagesAsTheyAre) {
  const Bytes destination = submessage(0x0e, 0x01, Bytes(12, 4));
  const Bytes acknack =
      submessage(0x06, 0x01, entities + sequence(3) + u32(33) + Bytes(8, 1) + u32(9));
  const Bytes nack =
      submessage(0x12, 0x01, entities + sequence(3) + u32(1) + u32(2) + u32(0) + u32(9));
  const Bytes message =
      header() + destination + stamp + data(key_hash() + sentinel) + heartbeat() + acknack + nack;
  EXPECT_EQ(passed(message), message);
}

Bytes acknack(unsigned char flags, std::uint64_t base, std::uint32_t count) {
  return submessage(0x06, flags, entities + sequence(base) + u32(0) + u32(count));
}

TEST(RtpsScreen, MakesAReaderThatBeginsAnewOneThatFastDdsTakesNoticeOf) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen screen(stamps, progress);
  const auto expect_passed = [&screen](const Bytes& message, const Bytes& expected) {
    const auto bytes = screen.pass(header() + message);
    EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), header() + expected);
  };
  expect_passed(acknack(0x03, 1, 0), acknack(0x03, 1, 0)); // asks for no answer: not that
  expect_passed(acknack(0x01, 1, 0), acknack(0x01, 0, 1)); // as Cyclone DDS begins anew
  expect_passed(acknack(0x01, 9, 40), acknack(0x01, 9, 41));
  expect_passed(acknack(0x01, 1, 0), acknack(0x01, 1, 1)); // a copy, which Fast DDS passes over
  // The same in big endian, of another reader.
  const Bytes other{0, 0, 2, 7, 0, 0, 1, 2};
  const Bytes body = other + Bytes{0, 0, 0, 0, 0, 0, 0, 1} + Bytes(8, 0);
  const Bytes begun = other + Bytes(15, 0) + Bytes{1};
  const Bytes head{0x06, 0x00, 0, 24};
  expect_passed(head + body, head + begun);
}

// As one in Fast DDS does that has forgotten its writer and heard a heartbeat before it said so.
TEST(RtpsScreen, MakesAReaderThatAsksForWhatItHadOneThatBeginsAnew) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen screen(stamps, progress);
  const auto asking = [](std::uint64_t base, std::uint32_t count) {
    return submessage(0x06, 0x01,
                      entities + sequence(base) + u32(9) + u32(0xff800000) + u32(count));
  };
  const auto expect_passed = [&screen](const Bytes& message, const Bytes& expected) {
    const auto bytes = screen.pass(header() + message);
    EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), header() + expected);
  };
  expect_passed(acknack(0x03, 12, 5), acknack(0x03, 12, 5));
  expect_passed(asking(1, 6), acknack(0x01, 0, 6));
  expect_passed(asking(1, 7), asking(1, 7));
}

TEST(RtpsScreen, TakesTheKeyHashOutOfFragments) {
  Bytes expected = header() + fragments({});
  const std::size_t key_hash_at = header().size() + 4 + 32;
  ASSERT_EQ(expected[key_hash_at], 0x70);
  expected[key_hash_at] = 0;
  EXPECT_EQ(passed(header() + fragments({})), expected);
}

TEST(RtpsScreen, GivesEveryFragmentTheStampOfItsSample) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen first_socket(stamps, progress);
  RtpsScreen screen(stamps, progress);
  const auto passed_now = [&screen](const Bytes& message) {
    const auto bytes = screen.pass(header() + message);
    EXPECT_FALSE(screen.refused());
    return Bytes(bytes.begin(), bytes.end());
  };
  const Bytes second = fragments({.first = 2, .qos = {}});
  EXPECT_EQ(passed_now(second), Bytes{}) << "Fast DDS would file the sample under time 0";
  EXPECT_EQ(passed_now(second + heartbeat()), header() + heartbeat());

  const Bytes begun = header() + stamp + fragments({.qos = {}});
  ASSERT_EQ(first_socket.pass(begun).size(), begun.size());
  const Bytes no_stamp = submessage(0x09, 0x03, {});
  EXPECT_EQ(passed_now(second), header() + stamp + second + no_stamp);
  EXPECT_EQ(passed_now(stamp + second), header() + stamp + second) << "has its own";
  EXPECT_EQ(passed_now(stamp + no_stamp + second),
            header() + stamp + no_stamp + stamp + second + no_stamp);
}

TEST(RtpsScreen, ReadsStampsInEitherByteOrder) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen screen(stamps, progress);
  const Bytes big_endian{0x09, 0x00, 0, 8, 0, 0, 0, 3, 0, 0, 0, 4};
  ASSERT_FALSE(screen.pass(header() + big_endian + fragments({.qos = {}})).empty());
  const auto bytes = screen.pass(header() + fragments({.first = 2, .qos = {}}));
  const Bytes expected = header() + submessage(0x09, 0x01, u32(3) + u32(4));
  ASSERT_GT(bytes.size(), expected.size());
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(expected.size())),
            expected);
  EXPECT_TRUE(screen.pass(header() + submessage(0x09, 0x01, u32(3))).empty());
  EXPECT_TRUE(screen.refused());
}

TEST(RtpsScreen, MakesAGapOfEveryRunOfAList) {
  // Of 40 samples from 12 on: the second and third, and the last.
  const Bytes words = u32(0x60000000) + u32(0x01000000);
  EXPECT_EQ(passed(header() + gap(10, 12, 40, words)),
            header() + gap(10, 12, 0, {}) + gap(13, 15, 0, {}) + gap(51, 52, 0, {}));
  EXPECT_EQ(passed(header() + gap(10, 10, 32, u32(0xffffffff))), header() + gap(10, 42, 0, {}));
  EXPECT_EQ(passed(header() + gap(10, 12, 0, {})), header() + gap(10, 12, 0, {}));
}

TEST(RtpsScreen, ReadsBigEndian) {
  const Bytes body = entities + Bytes{0, 0, 0, 0, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 12} +
                     Bytes{0, 0, 0, 3, 0x20, 0, 0, 0};
  const Bytes message = header() + Bytes{0x08, 0x00, 0, static_cast<unsigned char>(body.size())};
  EXPECT_EQ(passed(message + body), header() + gap(10, 12, 0, {}) + gap(14, 15, 0, {}));
}

TEST(RtpsScreen, TellsWhatIsMalformedFromWhatNobodyNeeds) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen screen(stamps, progress);
  const auto refuses = [&screen](const Bytes& datagram) {
    static_cast<void>(screen.pass(datagram));
    return screen.refused();
  };
  EXPECT_FALSE(refuses(header() + heartbeat()));
  EXPECT_FALSE(refuses(header() + submessage(0x80, 0x01, Bytes(48, 1))));
  EXPECT_TRUE(refuses(header() + submessage(0x07, 0x01, Bytes(4, 1))));
  EXPECT_TRUE(refuses(Bytes(40, 1)));
  EXPECT_FALSE(refuses(header() + heartbeat()));
}

TEST(RtpsScreen, LeavesOutWhatNobodyNeeds) {
  const Bytes statistics = submessage(0x80, 0x01, Bytes(48, 1));
  const Bytes pad = submessage(0x01, 0x01, {});
  EXPECT_EQ(passed(header() + statistics + heartbeat() + pad), header() + heartbeat());
  EXPECT_TRUE(passed(header() + statistics).empty());
}

TEST(RtpsScreen, LetsALengthOfZeroReachToTheEnd) {
  Bytes open = heartbeat();
  open[2] = 0;
  EXPECT_EQ(passed(header() + open), header() + heartbeat());
}

TEST(RtpsScreen, DropsWhatIsNoMessage) {
  EXPECT_TRUE(passed({}).empty());
  EXPECT_TRUE(passed(header()).empty());
  Bytes other = header() + heartbeat();
  other[0] = 'X';
  EXPECT_TRUE(passed(other).empty());
  other = header() + heartbeat();
  other[4] = 1;
  EXPECT_TRUE(passed(other).empty());
}

TEST(RtpsScreen, DropsAMessageWithASubmessageThatEndsTooSoon) {
  for (const Bytes& one :
       {heartbeat(), data(key_hash() + sentinel), fragments({}), gap(1, 2, 40, Bytes(8, 0xff)),
        submessage(0x06, 0x01, entities + sequence(3) + u32(33) + Bytes(8, 1) + u32(9)),
        submessage(0x0e, 0x01, Bytes(12, 4)), submessage(0x0c, 0x01, Bytes(20, 4))}) {
    for (std::size_t kept = 4; kept < one.size(); ++kept) {
      Bytes shorter(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(kept));
      shorter[2] = static_cast<unsigned char>(kept - 4);
      shorter[3] = 0;
      const bool still_data = one[0] == 0x15 && kept > one.size() - 8; // with a shorter sample
      EXPECT_EQ(passed(header() + heartbeat() + shorter).empty(), !still_data)
          << "submessage " << int{one[0]} << " of " << kept << " bytes";
      shorter = Bytes(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(kept));
      EXPECT_TRUE(passed(header() + heartbeat() + shorter).empty());
    }
  }
}

TEST(RtpsScreen, DropsFragmentsThatAreNotWithinTheirSample) {
  EXPECT_FALSE(passed(header() + fragments({})).empty());
  for (const Fragments& later :
       {Fragments{.first = 3, .payload = 50}, Fragments{.first = 2, .count = 2, .payload = 150}}) {
    EXPECT_EQ(passed(header() + stamp + fragments(later)).size(),
              header().size() + stamp.size() + (fragments(later).size() + 3) / 4 * 4);
  }
  const std::uint32_t too_long = max_sample_bytes + 1;
  for (const Fragments& wrong :
       {Fragments{.first = 0}, Fragments{.first = 4}, Fragments{.first = 0xffffffff},
        Fragments{.count = 0}, Fragments{.count = 4, .payload = 400}, Fragments{.count = 0xffff},
        Fragments{.payload = 99}, Fragments{.fragment_bytes = 0}, Fragments{.fragment_bytes = 63},
        Fragments{.fragment_bytes = 251, .payload = 300}, Fragments{.sample_bytes = 99},
        Fragments{.sample_bytes = too_long}, Fragments{.first = 3, .payload = 49}}) {
    EXPECT_TRUE(passed(header() + stamp + fragments(wrong)).empty())
        << wrong.first << ' ' << wrong.count << ' ' << wrong.fragment_bytes << ' '
        << wrong.sample_bytes << ' ' << wrong.payload;
  }
}

TEST(RtpsScreen, DropsInlineQosWithoutEndAndSequencesThatCannotBe) {
  EXPECT_TRUE(passed(header() + data(key_hash())).empty());
  EXPECT_TRUE(passed(header() + data(u16(0x70) + u16(0xffff) + Bytes(16, 0) + sentinel)).empty());
  EXPECT_TRUE(passed(header() + data(sentinel, 0x0f)).empty()) << "data and key";
  EXPECT_TRUE(passed(header() + gap(0, 2, 0, {})).empty());
  EXPECT_EQ(passed(header() + gap(1, 1ULL << 40U, 0, {})),
            header() + gap(1, 1 + ReaderProgress::window, 0, {}));
  EXPECT_TRUE(passed(header() + gap(1, 2, 257, Bytes(36, 0))).empty());
  EXPECT_TRUE(passed(header() + gap(1ULL << 63U, 2, 0, {})).empty());
}

TEST(RtpsScreen, IsUsedAgainAndAgain) {
  SampleStamps stamps;
  ReaderProgress progress;
  RtpsScreen screen(stamps, progress);
  const Bytes message = header() + heartbeat();
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(screen.pass(header()).empty());
    EXPECT_EQ(screen.pass(message).size(), message.size());
  }
}

} // namespace
} // namespace dyncal::bus
