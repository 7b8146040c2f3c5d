#include "drivers/virtual_bench/wire/receive_queue.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sstream>
#include <sys/socket.h>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

TEST(ReceiveQueue, ReadsTheKernelsTable) {
  std::istringstream table("  sl  local_address rem_address   st tx_queue rx_queue tr tm->when "
                           "retrnsmt   uid  timeout inode ref pointer drops\n"
                           "  101: 0100007F:1DE6 00000000:0000 07 00000001:00001200 00:00000000 "
                           "00000000     0        0 5 2 0 0\n"
                           "  102: 00000000:1DE6 00000000:0000 07 00000000:00000240 00:00000000 "
                           "00000000     0        0 6 2 0 0\n"
                           "  103: 00000000:1DE7 00000000:0000 07 00000000:0000FFFF 00:00000000 "
                           "00000000     0        0 7 2 0 0\n");
  EXPECT_EQ(udp_receive_queue(table, 7654), 0x1200U);
}

TEST(ReceiveQueue, SeesWhatNobodyHasRead) {
  const FileDescriptor receiver(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(receiver.number(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  socklen_t size = sizeof(address);
  getsockname(receiver.number(), reinterpret_cast<sockaddr*>(&address), &size);
  const std::uint16_t port = ntohs(address.sin_port);
  EXPECT_EQ(udp_receive_queue(port), 0U);
  const FileDescriptor sender(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const char datagram[900] = {};
  sendto(sender.number(), datagram, sizeof(datagram), 0, reinterpret_cast<sockaddr*>(&address),
         sizeof(address));
  EXPECT_GE(udp_receive_queue(port), sizeof(datagram));
}

TEST(ReceiveQueue, KnowsTheNamesOfThisHost) {
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_TRUE(is_loopback("localhost"));
  EXPECT_FALSE(is_loopback("10.9.0.1"));
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
