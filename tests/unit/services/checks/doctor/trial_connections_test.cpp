#include "services/checks/doctor/trial_connections.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr const char* here = "127.0.0.1";

// A port of this host, at which connections are taken as far as the queue has room.
struct Listener {
  explicit Listener(int room) : socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(socket.number(), reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(socket.number(), reinterpret_cast<sockaddr*>(&address), &size), 0);
    EXPECT_EQ(listen(socket.number(), room), 0);
    port = ntohs(address.sin_port);
  }
  drivers::FileDescriptor socket;
  int port = 0;
};

TEST(TrialConnections, CountARefusalAsAnAnswer) {
  int port = 0;
  { port = Listener(1).port; }
  const auto tried = try_hosts({here}, {}, port);
  ASSERT_TRUE(tried.contains(here));
  EXPECT_EQ(tried.at(here).begun, 40U);
  EXPECT_EQ(tried.at(here).in_time, 40U);
  EXPECT_EQ(tried.at(here).missed_part(), 0.0);
}

TEST(TrialConnections, CountWhatIsTaken) {
  const Listener listener(100);
  EXPECT_EQ(try_hosts({here}, {}, listener.port).at(here).in_time, 40U);
}

// The kernel answers no more than there is room for, and nobody makes any.
TEST(TrialConnections, MissWhatIsNotAnswered) {
  const Listener listener(4);
  const auto began = std::chrono::steady_clock::now();
  const TriedHost tried = try_hosts({here}, {}, listener.port).at(here);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(10));
  EXPECT_EQ(tried.begun, 40U);
  EXPECT_GT(tried.in_time, 0U);
  EXPECT_LT(tried.in_time, 10U);
  EXPECT_GT(tried.missed_part(), 0.7);
}

TEST(TrialConnections, BeginNoneOnceTheyAreStopped) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(try_hosts({here}, stop.get_token()).at(here).begun, 0U);
}

TEST(TrialConnections, LeaveOutWhatIsNoAddress) {
  EXPECT_TRUE(try_hosts({"lab-2", ""}, {}).empty());
}

// A network of its own, with loopback alone, for the thread.
TEST(TrialConnections, TellAHostThatNoRouteLeadsTo) {
  std::optional<TriedHost> tried;
  std::thread([&] {
    if (unshare(CLONE_NEWNET) == 0) {
      tried = try_hosts({"192.0.2.7"}, {}).at("192.0.2.7");
    }
  }).join();
  if (!tried) {
    GTEST_SKIP() << "skipped: a network namespace needs root";
  }
  EXPECT_TRUE(tried->has_no_route);
  EXPECT_EQ(tried->in_time + tried->late, 0U);
  const Listener listener(100);
  EXPECT_FALSE(try_hosts({here}, {}, listener.port).at(here).has_no_route);
}

} // namespace
} // namespace dyncal::inline checks::doctor
