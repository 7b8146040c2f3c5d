// Packets that are not RTPS as it should be are counted, whichever vendor gets them.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <functional>

#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/bus/vendor.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"
#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;

// A right header, and a HEARTBEAT that is too short.
constexpr unsigned char malformed_heartbeat[] = {'R', 'T', 'P', 'S', 2, 1, 1, 15, 9, 9,    9,
                                                 9,   9,   9,   9,   9, 9, 9, 9,  9, 0x07, 0x01,
                                                 8,   0,   0,   0,   0, 0, 0, 0,  0, 0};

class RefusedByVendor : public testing::TestWithParam<Vendor> {
protected:
  static Participant join() {
    ParticipantOptions options;
    options.vendor = GetParam();
    options.domain = tests::own_dds_domain();
    options.name = "refused packets test";
    options.interface_name = "lo";
    return Participant::create(options).value();
  }
  static Bytes malformed() {
    return {std::begin(malformed_heartbeat), std::end(malformed_heartbeat)};
  }
  static Bytes data(std::uint32_t number) {
    const Bytes entities{0, 0, 1, 7, 0, 0, 1, 2};
    return header() + submessage(0x15, 0x05,
                                 u16(0) + u16(16) + entities + sequence(number) +
                                     Bytes{0, 1, 0, 0, 1, 2, 3, 4});
  }
  // Sends by and by to the first participant of this domain (DDSI-RTPS 9.6.1.1) until one more is
  // counted.
  static bool is_counted(const RefusedPackets& refused, const std::function<Bytes()>& next,
                         int at_once) {
    const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * tests::own_dds_domain()));
    const std::uint64_t before = refused.count();
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    WakeUp never;
    while (refused.count() == before && std::chrono::steady_clock::now() < deadline) {
      for (int i = 0; i < at_once; ++i) {
        const Bytes datagram = next();
        EXPECT_EQ(sendto(descriptor, datagram.data(), datagram.size(), 0,
                         reinterpret_cast<const sockaddr*>(&address), sizeof address),
                  static_cast<ssize_t>(datagram.size()));
      }
      never.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
    }
    close(descriptor);
    return refused.count() > before;
  }
};

INSTANTIATE_TEST_SUITE_P(EachVendor, RefusedByVendor, testing::ValuesIn(vendors_in_this_build()),
                         [](const auto& vendor) { return to_string(vendor.param); });

TEST_P(RefusedByVendor, MalformedPacketsAreCounted) {
  const Participant participant = join();
  const auto refused = participant.refused_packets();
  EXPECT_TRUE(is_counted(*refused, malformed, 1));
  if (GetParam() == Vendor::fast_dds) {
    EXPECT_EQ(refused->last_sender(), "127.0.0.1");
  }
}

// Cyclone DDS announces itself in longer ones than ours unless it has our profile.
TEST_P(RefusedByVendor, PacketsLongerThanOursAreNotMalformed) {
  const Participant participant = join();
  const auto refused = participant.refused_packets();
  const Bytes padding = header() + submessage(0x01, 0x01, Bytes(3000));
  constexpr std::uint64_t long_ones = 20;
  std::uint64_t sent = 0;
  EXPECT_TRUE(is_counted(
      *refused,
      [&] {
        ++sent;
        return sent > long_ones ? malformed() : padding;
      },
      1));
  EXPECT_GT(sent, long_ones);
  EXPECT_LT(refused->count(), long_ones); // Cyclone DDS counts one that is malformed twice
}

TEST_P(RefusedByVendor, PacketsThatJumpAreCountedWhenThereAreMany) {
  if (GetParam() == Vendor::cyclone_dds) {
    GTEST_SKIP() << "Cyclone DDS reads what comes as it comes";
  }
  Participant participant = join();
  const auto reader = participant.reader(topics::command, "bench", nullptr);
  ASSERT_TRUE(reader);
  std::uint32_t sent = 0;
  EXPECT_TRUE(is_counted(
      *participant.refused_packets(),
      [&] {
        ++sent;
        return data(sent % 100 < 2 ? 1 + sent % 100 : 1'000'000'000 - sent); // none goes on
      },
      100));
  EXPECT_GT(sent, RefusedPackets::many_implausible / 2) << "real ones of others count as well";
  EXPECT_EQ(participant.refused_packets()->last_sender(), "127.0.0.1");
}

} // namespace
} // namespace dyncal::bus
