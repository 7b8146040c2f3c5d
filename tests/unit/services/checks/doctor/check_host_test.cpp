#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/host_view.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/checks/doctor/findings.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::problems;
using tests::warnings;

HostView sound_host() {
  return {.receive_buffer_bytes = 8 << 20,
          .interfaces = {{.name = "lo", .address = "127.0.0.1", .mtu = 65536, .loopback = true},
                         {.name = "eth0", .address = "192.0.2.10", .mtu = 1500}},
          .without_ipv4 = {},
          .link_changes_before = {},
          .link_changes_after = {},
          .queues_before = {},
          .queues_after = {},
          .tried = {},
          .multicast_loops = true,
          .udp_before = UdpCounters{.received = 100, .without_room = 0, .damaged = 0},
          .udp_after = UdpCounters{.received = 200, .without_room = 0, .damaged = 0},
          .output_folder = "/home/lab",
          .free_bytes = std::uint64_t{100} << 30U,
          .output_writable = true};
}

TEST(CheckHost, IsContentWithASoundHost) {
  EXPECT_THAT(problems(check_host(sound_host(), 0)), IsEmpty());
  EXPECT_THAT(warnings(check_host(sound_host(), 0)), IsEmpty());
}

TEST(CheckHost, NamesASmallBuffer) {
  HostView host = sound_host();
  host.receive_buffer_bytes = 212992;
  EXPECT_THAT(warnings(check_host(host, 0)), ElementsAre(HasSubstr("net.core.rmem_max")));
}

TEST(CheckHost, NamesASmallMtu) {
  HostView host = sound_host();
  host.interfaces[1].mtu = 1400;
  EXPECT_THAT(warnings(check_host(host, 0)),
              ElementsAre(HasSubstr("eth0 (192.0.2.10) has an MTU of 1400")));
}

TEST(CheckHost, NamesAHostThatCannotReachItself) {
  HostView host = sound_host();
  host.interfaces[1].reaches_itself = false;
  EXPECT_THAT(problems(check_host(host, 0)),
              ElementsAre(HasSubstr("our own address 192.0.2.10 (eth0) does not arrive")));
}

TEST(CheckHost, NamesMulticastThatDoesNotComeBack) {
  HostView host = sound_host();
  host.multicast_loops = false;
  EXPECT_THAT(warnings(check_host(host, 0)), ElementsAre(HasSubstr("does not come back")));
}

TEST(CheckHost, NamesAHostWithoutNetwork) {
  HostView host = sound_host();
  host.interfaces.pop_back();
  EXPECT_THAT(warnings(check_host(host, 0)), ElementsAre(HasSubstr("no network but loopback")));
}

TEST(CheckHost, CountsPacketsThatWereLostMeanwhile) {
  HostView host = sound_host();
  host.udp_before->without_room = 5;
  host.udp_after->without_room = 12;
  EXPECT_THAT(warnings(check_host(host, 0)), ElementsAre(HasSubstr("7 UDP packets were dropped")));
}

TEST(CheckHost, NamesAFullDisk) {
  HostView host = sound_host();
  host.free_bytes = std::uint64_t{500} << 20U;
  EXPECT_THAT(warnings(check_host(host, 0)),
              ElementsAre(HasSubstr("only 500 MB are free in /home/lab")));
  host.free_bytes = std::uint64_t{10} << 20U;
  EXPECT_THAT(problems(check_host(host, 0)), ElementsAre(HasSubstr("only 10 MB")));
}

TEST(CheckHost, NamesADomainWhosePortsAreOthers) {
  EXPECT_THAT(warnings(check_host(sound_host(), 150)), ElementsAre(HasSubstr("domain 150")));
}

TEST(HostViewTest, SeesThisHost) {
  const tests::TemporaryFolder folder;
  const HostView host = look_at_host(folder.path());
  EXPECT_GT(host.receive_buffer_bytes, 0);
  ASSERT_FALSE(host.interfaces.empty());
  EXPECT_GT(host.interfaces[0].mtu, 0);
  EXPECT_TRUE(host.interfaces[0].reaches_itself);
  ASSERT_TRUE(host.udp_before);
  EXPECT_GT(host.udp_before->received, 0U);
  EXPECT_TRUE(host.output_writable);
  EXPECT_GT(host.free_bytes.value_or(0), 0U);
}

} // namespace
} // namespace dyncal::inline checks::doctor
