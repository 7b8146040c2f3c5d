// Packets that are not RTPS as it should be are counted, whichever vendor gets them.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::bus {
namespace {

// A right header, and a HEARTBEAT that is too short.
constexpr unsigned char malformed[] = {'R', 'T', 'P', 'S', 2, 1, 1, 15, 9, 9,    9,
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
  // To the first participant of this domain (DDSI-RTPS 9.6.1.1).
  static void send_malformed() {
    const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * tests::own_dds_domain()));
    EXPECT_EQ(sendto(descriptor, malformed, sizeof malformed, 0,
                     reinterpret_cast<const sockaddr*>(&address), sizeof address),
              static_cast<ssize_t>(sizeof malformed));
    close(descriptor);
  }
};

INSTANTIATE_TEST_SUITE_P(EachVendor, RefusedByVendor, testing::ValuesIn(vendors_in_this_build()),
                         [](const auto& vendor) { return to_string(vendor.param); });

TEST_P(RefusedByVendor, MalformedPacketsAreCounted) {
  const Participant participant = join();
  const auto refused = participant.refused_packets();
  const std::uint64_t before = refused->count();
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  WakeUp never;
  while (refused->count() == before && std::chrono::steady_clock::now() < deadline) {
    send_malformed();
    never.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
  }
  EXPECT_GT(refused->count(), before);
  if (GetParam() == Vendor::fast_dds) {
    EXPECT_EQ(refused->last_sender(), "127.0.0.1");
  }
}

} // namespace
} // namespace dyncal::bus
