#include "drivers/link/tcp_connection.hpp"

#include <cerrno>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "tests/patience.hpp"

namespace dyncal::drivers {
namespace {

// The other end, which hears how it is left.
class Listener {
public:
  Listener() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* raw = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof(address);
    EXPECT_EQ(::bind(socket_.number(), raw, size), 0);
    EXPECT_EQ(::listen(socket_.number(), 1), 0);
    EXPECT_EQ(getsockname(socket_.number(), raw, &size), 0);
    port_ = ntohs(address.sin_port);
  }
  [[nodiscard]] Address address() const { return {"127.0.0.1", port_}; }
  [[nodiscard]] FileDescriptor accepted() const {
    return FileDescriptor(accept(socket_.number(), nullptr, nullptr));
  }

private:
  FileDescriptor socket_;
  std::uint16_t port_ = 0;
};

// 0 after a farewell, else the error.
int how_it_was_left(const FileDescriptor& other_end) {
  char byte = 0;
  return recv(other_end.number(), &byte, 1, 0) < 0 ? errno : 0;
}

TEST(TcpConnection, IsAbandonedWithoutAFarewellThatTheKernelWouldGoOnDelivering) {
  const StopSignal never;
  const Listener listener;
  auto connection = TcpConnection::connect(listener.address(), tests::patience, never);
  ASSERT_TRUE(connection) << connection.error().message;
  const FileDescriptor other_end = listener.accepted();
  connection->abandon();
  EXPECT_EQ(how_it_was_left(other_end), ECONNRESET);
  EXPECT_EQ(connection->send_all("x", tests::patience).error().code, ErrorCode::disconnected);
  EXPECT_FALSE(connection->has_unread());
}

TEST(TcpConnection, EndsWithAFarewellOtherwise) {
  const StopSignal never;
  const Listener listener;
  FileDescriptor other_end;
  {
    const auto connection = TcpConnection::connect(listener.address(), tests::patience, never);
    ASSERT_TRUE(connection) << connection.error().message;
    other_end = listener.accepted();
  }
  EXPECT_EQ(how_it_was_left(other_end), 0);
}

} // namespace
} // namespace dyncal::drivers
