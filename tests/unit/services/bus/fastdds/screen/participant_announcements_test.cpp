#include "services/bus/fastdds/screen/participant_announcements.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;

const Bytes participants{0, 1, 0, 0xc2};
const Bytes publications{0, 0, 3, 0xc2};
const Bytes sentinel = u16(1) + u16(0);

Bytes parameter(unsigned id, const Bytes& value) {
  return u16(id) + u16(static_cast<unsigned>(value.size())) + value;
}

Bytes guid_of(const Bytes& prefix, unsigned parameter_id = 0x50) {
  return parameter(parameter_id, prefix + Bytes{0, 0, 1, 0xc1});
}

Bytes lease(std::uint32_t seconds) {
  return parameter(0x02, u32(seconds) + u32(0));
}

class Announcements : public testing::Test {
protected:
  ParticipantAnnouncements announcements_;
  ParticipantAnnouncements::Instant now_{};
  rtps_format::Prefix from_{};

  Announcements() { std::ranges::copy(participant, from_.begin()); }

  bool announced(const Bytes& writer, const Bytes& parameters, unsigned char flags = 0x05,
                 std::uint64_t number = 1) {
    return announcements_.accepts(from_, flags,
                                  u16(0) + u16(16) + Bytes(4, 0) + writer + sequence(number) +
                                      Bytes{0, 3, 0, 0} + parameters,
                                  now_);
  }
  bool goodbye(const Bytes& writer) {
    constexpr unsigned char key_and_qos = 0x0b;
    return announcements_.accepts(from_, key_and_qos,
                                  u16(0) + u16(16) + Bytes(4, 0) + writer + sequence(2) +
                                      parameter(0x71, {0, 0, 0, 3}) + sentinel + Bytes(20, 0),
                                  now_);
  }
  bool announced(std::uint32_t lease_s, const Bytes& more = {}) {
    return announced(participants, guid_of(participant) + lease(lease_s) + more + sentinel);
  }
};

TEST_F(Announcements, AreOfThemselves) {
  EXPECT_TRUE(announced(participants, guid_of(participant) + sentinel));
  EXPECT_FALSE(announced(participants, guid_of(Bytes(12, 7)) + sentinel));
  EXPECT_FALSE(announced(participants, lease(10) + sentinel)) << "without a name";
  const Bytes endpoint = participant + Bytes{0, 0, 1, 2};
  EXPECT_FALSE(announced(participants, parameter(0x50, endpoint) + sentinel));
  EXPECT_TRUE(announced(publications, guid_of(participant, 0x5a) + sentinel));
  EXPECT_FALSE(announced(publications, guid_of(Bytes(12, 7), 0x5a) + sentinel));
}

TEST_F(Announcements, AreAsLongAsTheySay) {
  const Bytes guid = guid_of(participant, 0x5a);
  const Bytes two = u16(0) + u16(2);
  EXPECT_TRUE(announced(publications, guid + parameter(0x73, u32(2) + two) + sentinel));
  EXPECT_TRUE(announced(publications, guid + parameter(0x73, u32(0)) + sentinel));
  EXPECT_FALSE(announced(publications, guid + parameter(0x73, u32(3) + two) + sentinel));
  EXPECT_FALSE(announced(publications, guid + parameter(0x73, u32(~0U) + two) + sentinel));
  EXPECT_FALSE(announced(publications, guid + parameter(0x73, u16(1)) + sentinel));
  EXPECT_FALSE(announced(10, parameter(0x1001, u32(~0U) + two))) << "a token";
}

TEST_F(Announcements, StayAsTheyAre) {
  EXPECT_TRUE(announced(10));
  EXPECT_FALSE(announced(0)) << "it would be gone at once";
  EXPECT_TRUE(announced(10));
  EXPECT_FALSE(announced(10, parameter(0x32, Bytes(24, 1)))) << "nobody would reach it";
  EXPECT_TRUE(announced(10, parameter(0x2c, Bytes(8, 1)))) << "user data may change";
}

TEST_F(Announcements, ChangeWhenTheChangeStays) {
  EXPECT_TRUE(announced(10));
  EXPECT_FALSE(announced(20));
  EXPECT_FALSE(announced(20));
  EXPECT_TRUE(announced(20));
  EXPECT_FALSE(announced(10));
}

TEST_F(Announcements, DoNotChangeBesideTheOldOne) {
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(announced(10));
    EXPECT_FALSE(announced(20));
    EXPECT_FALSE(announced(20));
  }
}

TEST_F(Announcements, AreListsOfParameters) {
  EXPECT_FALSE(announced(participants, guid_of(participant))) << "no end";
  EXPECT_FALSE(announced(participants, u16(0x02) + u16(200) + sentinel)) << "beyond the end";
  EXPECT_FALSE(announced(participants, {}));
}

TEST_F(Announcements, EndOnce) {
  EXPECT_TRUE(goodbye(participants)) << "of somebody unknown, which ends nothing";
  EXPECT_TRUE(announced(10));
  EXPECT_TRUE(goodbye(participants));
  EXPECT_TRUE(announced(10)) << "it was not its own";
  EXPECT_FALSE(goodbye(participants));
  EXPECT_TRUE(goodbye(publications)) << "a writer may end whenever it likes";
}

TEST_F(Announcements, OfAWriterKeepTheirNumber) {
  const auto of_writer = [this](std::uint64_t number) {
    return announced(publications, guid_of(participant, 0x5a) + sentinel, 0x05, number);
  };
  EXPECT_TRUE(of_writer(7));
  EXPECT_FALSE(of_writer(8)) << "another writer will have it";
  EXPECT_TRUE(of_writer(7));
  EXPECT_FALSE(of_writer(9)) << "the writer changes";
  EXPECT_FALSE(of_writer(9));
  EXPECT_TRUE(of_writer(9)) << "and says so to whoever asks";
}

TEST_F(Announcements, AreForgottenWithAllOfTheirParticipantOnceItIsSilent) {
  EXPECT_TRUE(announced(10));
  const Bytes of_writer = parameter(0x5a, participant + Bytes{0, 0, 1, 2}) + sentinel;
  EXPECT_TRUE(announced(publications, of_writer, 0x05, 1));
  now_ += ParticipantAnnouncements::silence_limit;
  EXPECT_TRUE(announcements_.forget_the_gone(now_).empty());
  EXPECT_FALSE(announced(publications, of_writer, 0x05, 2)) << "another number";
  now_ += std::chrono::nanoseconds(1);
  EXPECT_EQ(announcements_.forget_the_gone(now_).size(), 1U);
  EXPECT_TRUE(announced(publications, of_writer, 0x05, 2)) << "as of a newcomer";
}

TEST_F(Announcements, DoNotEndBecauseOfAChangedFlag) {
  EXPECT_TRUE(announced(10));
  constexpr unsigned char key_only = 0x09;
  EXPECT_FALSE(announced(participants, guid_of(participant) + lease(0) + sentinel, key_only));
  EXPECT_TRUE(goodbye(participants)) << "its own counts";
}

TEST_F(Announcements, OtherDataIsLeftToOthers) {
  EXPECT_TRUE(announced({0, 0, 1, 2}, Bytes(3, 9)));
  EXPECT_TRUE(announcements_.accepts(from_, 0x05, Bytes(5, 0), now_)) << "not whole";
}

TEST(AnnouncesParticipant, WhereASubmessageIsOfTheWriterOfParticipants) {
  const auto of_writer = [](const Bytes& writer) {
    return submessage(0x15, 0x05, u16(0) + u16(16) + Bytes(4, 0) + writer + sequence(1));
  };
  const Bytes stamp = submessage(0x09, 0x01, Bytes(8, 0));
  EXPECT_TRUE(announces_participant(header() + of_writer(participants)));
  EXPECT_TRUE(announces_participant(header() + stamp + of_writer(participants) + stamp));
  EXPECT_FALSE(announces_participant(header() + stamp + of_writer(publications)));
  EXPECT_FALSE(announces_participant(header() + submessage(0x15, 0x05, Bytes(11, 0))));
  EXPECT_FALSE(announces_participant(header()));
}

} // namespace
} // namespace dyncal::bus
