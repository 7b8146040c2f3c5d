#include "services/daemon/supervision/service_manager.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/daemon/supervision/notify_socket.hpp"

namespace dyncal::inline daemon {
namespace {

using namespace std::chrono_literals;

class ServiceManagerTest : public ::testing::Test {
protected:
  void SetUp() override {
    if (!can_notify_service_manager()) {
      GTEST_SKIP() << "this build has no libsystemd";
    }
  }

  tests::TemporaryFolder folder_;
  tests::NotifySocket socket_{folder_.path().string(), 8s};
  ServiceManager::Clock::time_point now_{1h};
};

TEST_F(ServiceManagerTest, ReportsReadyAtTheFirstTurnAfterEverythingIsThere) {
  ServiceManager manager;
  manager.turned(now_);
  EXPECT_EQ(socket_.next(), "") << "a loop alone does not serve";
  manager.serving("bench acc-1");
  EXPECT_EQ(socket_.next(), "") << "the loop has not turned since";
  manager.turned(now_);
  EXPECT_EQ(socket_.next(), "READY=1\nSTATUS=bench acc-1");
}

TEST_F(ServiceManagerTest, ShowsTheWatchdogThatTheLoopTurns) {
  ServiceManager manager;
  manager.serving("");
  manager.turned(now_);
  EXPECT_EQ(socket_.next(), "READY=1\nSTATUS=");
  EXPECT_EQ(socket_.next(), "WATCHDOG=1");
  for (int turn = 0; turn < 100; ++turn) {
    manager.turned(now_ += 100ms); // ten seconds
  }
  int signs = 0;
  for (std::string sign = socket_.next(); !sign.empty(); sign = socket_.next()) {
    EXPECT_EQ(sign, "WATCHDOG=1");
    ++signs;
  }
  EXPECT_EQ(signs, 5) << "one every two seconds";
}

TEST_F(ServiceManagerTest, SendsNothingWhileTheLoopHangs) {
  ServiceManager manager;
  manager.serving("");
  manager.turned(now_);
  while (!socket_.next().empty()) {
  }
  manager.serving("");
  EXPECT_EQ(socket_.next(50ms), "");
}

TEST_F(ServiceManagerTest, ReportsItsEndOnceAndNoTurnAfterIt) {
  ServiceManager manager;
  manager.serving("");
  manager.turned(now_);
  while (!socket_.next().empty()) {
  }
  manager.stopping();
  manager.stopping();
  manager.turned(now_ + 1min);
  EXPECT_EQ(socket_.next(), "STOPPING=1");
  EXPECT_EQ(socket_.next(), "");
}

TEST_F(ServiceManagerTest, SendsNoWatchdogWhereNobodyWatches) {
  unsetenv("WATCHDOG_USEC");
  ServiceManager manager;
  manager.serving("");
  manager.turned(now_);
  manager.turned(now_ + 1min);
  EXPECT_EQ(socket_.next(), "READY=1\nSTATUS=");
  EXPECT_EQ(socket_.next(), "");
}

TEST_F(ServiceManagerTest, DoesNothingWithoutAServiceManager) {
  unsetenv("NOTIFY_SOCKET");
  ServiceManager manager;
  manager.serving("");
  manager.turned(now_);
  manager.stopping();
  EXPECT_EQ(socket_.next(), "");
}

} // namespace
} // namespace dyncal::inline daemon
