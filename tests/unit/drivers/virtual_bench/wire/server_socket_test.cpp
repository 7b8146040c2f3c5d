#include "drivers/virtual_bench/wire/server_socket.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <gtest/gtest.h>

namespace dyncal::drivers::virtual_bench {
namespace {

int segment_bytes(const FileDescriptor& socket) {
  int bytes = 0;
  socklen_t size = sizeof(bytes);
  EXPECT_EQ(getsockopt(socket.number(), IPPROTO_TCP, TCP_MAXSEG, &bytes, &size), 0);
  return bytes;
}

// A longer one, as the loopback interface has, fills the small buffer of a stream alone: the sender
// then waits for the receiver's late answer to it, 25 times a second.
TEST(ServerSocket, SegmentsAreThoseOfAnEthernetOnTheLoopbackInterfaceToo) {
  const auto listener = listen_tcp({"127.0.0.1", 0});
  ASSERT_TRUE(listener) << listener.error().message;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(local_port(*listener));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const FileDescriptor client(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(connect(client.number(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  pollfd waiting{.fd = listener->number(), .events = POLLIN, .revents = 0};
  ASSERT_EQ(poll(&waiting, 1, 10'000), 1);
  const FileDescriptor server = accept_client(*listener);
  ASSERT_TRUE(server.is_open());
  EXPECT_GT(segment_bytes(server), 0);
  EXPECT_LE(segment_bytes(server), 1448);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
