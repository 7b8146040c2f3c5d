#include "services/bus/fastdds/screen/discovery_heartbeats.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/fastdds/screen/rtps_format.hpp"
#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;
using rtps_format::little_endian_flag;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

const Bytes of_publications{0, 0, 3, 0xc2};
const Bytes of_subscriptions{0, 0, 4, 0xc2};
const Bytes of_samples{0, 0, 5, 2};

Bytes heartbeat(const Bytes& writer, std::uint64_t last, std::uint32_t count) {
  return submessage(rtps_format::heartbeat, little_endian_flag,
                    Bytes(4) + writer + sequence(1) + sequence(last) + u32(count));
}

Bytes data(const Bytes& writer, std::uint64_t number) {
  return submessage(rtps_format::data, little_endian_flag,
                    u16(0) + u16(16) + Bytes(4) + writer + sequence(number) + Bytes(40, 0xdd));
}

Bytes to(unsigned char participant) {
  return submessage(rtps_format::info_destination, little_endian_flag, Bytes(12, participant));
}

class DiscoveryHeartbeatsTest : public testing::Test {
protected:
  // As it goes.
  Bytes send(const Bytes& submessages, std::size_t destination = 1) {
    const auto counted = heartbeats_.counted(header() + submessages);
    if (!counted) {
      return header() + submessages;
    }
    heartbeats_.sent(*counted, destination, now_);
    return *counted;
  }

  std::vector<Bytes> due_after(milliseconds time) {
    now_ += time;
    std::vector<Bytes> datagrams;
    for (const auto& due : heartbeats_.due(now_)) {
      datagrams.push_back(due.datagram);
    }
    return datagrams;
  }

  DiscoveryHeartbeats heartbeats_;
  DiscoveryHeartbeats::Instant now_{std::chrono::hours(1)};
};

TEST_F(DiscoveryHeartbeatsTest, GoAgainAndCountOn) {
  EXPECT_EQ(send(to(9) + heartbeat(of_publications, 4, 1)),
            header() + to(9) + heartbeat(of_publications, 4, 1));
  EXPECT_THAT(due_after(milliseconds(39)), IsEmpty());
  constexpr auto repeats = static_cast<std::uint32_t>(DiscoveryHeartbeats::max_repeats);
  for (std::uint32_t i = 0; i < repeats; ++i) {
    const auto wait = i == 0 ? milliseconds(1) : DiscoveryHeartbeats::next_repeat;
    EXPECT_THAT(due_after(wait),
                ElementsAre(header() + to(9) + heartbeat(of_publications, 4, i + 2)))
        << i;
    EXPECT_THAT(due_after(milliseconds(0)), IsEmpty());
  }
  EXPECT_THAT(due_after(std::chrono::hours(1)), IsEmpty());
  // Fast DDS knows nothing of the repeats, and readers must believe it nevertheless.
  EXPECT_EQ(send(heartbeat(of_publications, 4, 2)),
            header() + heartbeat(of_publications, 4, repeats + 2));
  EXPECT_THAT(due_after(std::chrono::hours(1)), IsEmpty()) << "nothing new was sent";
}

TEST_F(DiscoveryHeartbeatsTest, TellOfTheNewestSample) {
  send(data(of_subscriptions, 1));
  EXPECT_THAT(due_after(std::chrono::hours(1)), IsEmpty()) << "no heartbeat is known yet";
  send(heartbeat(of_subscriptions, 2, 1) + data(of_subscriptions, 3));
  EXPECT_THAT(due_after(milliseconds(40)),
              ElementsAre(header() + heartbeat(of_subscriptions, 3, 2)));
  while (!due_after(DiscoveryHeartbeats::next_repeat).empty()) {
  }
  send(data(of_subscriptions, 3)); // a repair
  EXPECT_THAT(due_after(milliseconds(40)), IsEmpty());
  send(data(of_subscriptions, 4));
  const auto count = static_cast<std::uint32_t>(DiscoveryHeartbeats::max_repeats) + 2;
  EXPECT_THAT(due_after(milliseconds(40)),
              ElementsAre(header() + heartbeat(of_subscriptions, 4, count)));
}

TEST_F(DiscoveryHeartbeatsTest, EndWhenAllIsAcknowledged) {
  send(to(9) + heartbeat(of_publications, 4, 1));
  const auto acknowledge = [&](unsigned char from, const Bytes& writer, std::uint64_t base) {
    heartbeats_.received(header(Bytes(12, from)) +
                         submessage(rtps_format::acknack, little_endian_flag,
                                    Bytes(4) + writer + sequence(base) + u32(0) + u32(1)));
    return due_after(DiscoveryHeartbeats::next_repeat).empty();
  };
  EXPECT_FALSE(acknowledge(8, of_publications, 5)) << "another participant";
  EXPECT_FALSE(acknowledge(9, of_subscriptions, 5)) << "to another writer";
  EXPECT_FALSE(acknowledge(9, of_publications, 4)) << "it lacks the newest";
  EXPECT_TRUE(acknowledge(9, of_publications, 5));
}

// A program that begins often has the address of one that has ended.
TEST_F(DiscoveryHeartbeatsTest, BeginAnewForAnotherParticipantAtTheSameDestination) {
  send(to(9) + heartbeat(of_publications, 4, 1));
  while (!due_after(DiscoveryHeartbeats::next_repeat).empty()) {
  }
  send(heartbeat(of_publications, 4, 2)); // to all that listen there
  EXPECT_THAT(due_after(std::chrono::hours(1)), IsEmpty());
  const Bytes sent = send(to(8) + heartbeat(of_publications, 4, 3));
  const auto repeated = due_after(milliseconds(40));
  ASSERT_EQ(repeated.size(), 1U);
  EXPECT_EQ(Bytes(repeated[0].begin(), repeated[0].end() - 4), Bytes(sent.begin(), sent.end() - 4));
}

TEST_F(DiscoveryHeartbeatsTest, AreOfEachWriterAndEachDestination) {
  send(heartbeat(of_publications, 1, 1), 1);
  send(heartbeat(of_subscriptions, 2, 1), 1);
  send(heartbeat(of_publications, 3, 2), 2);
  now_ += milliseconds(40);
  std::vector<std::size_t> destinations;
  for (const auto& due : heartbeats_.due(now_)) {
    destinations.push_back(due.destination);
  }
  EXPECT_THAT(destinations, ElementsAre(1, 1, 2));
}

TEST_F(DiscoveryHeartbeatsTest, LeaveEverythingElseAlone) {
  EXPECT_FALSE(heartbeats_.counted(header() + heartbeat(of_samples, 1, 7)));
  EXPECT_FALSE(heartbeats_.counted(header() + data(of_samples, 1)));
  EXPECT_FALSE(heartbeats_.counted(header()));
  EXPECT_FALSE(heartbeats_.counted(
      header() + submessage(rtps_format::heartbeat, little_endian_flag, Bytes(20))));
}

TEST_F(DiscoveryHeartbeatsTest, AreBounded) {
  for (std::size_t i = 0; i < DiscoveryHeartbeats::max_destinations + 3; ++i) {
    send(heartbeat(of_publications, 1, 1), i);
  }
  EXPECT_EQ(due_after(milliseconds(40)).size(), DiscoveryHeartbeats::max_destinations);
}

} // namespace
} // namespace dyncal::bus
