#include "drivers/link/stop_signal.hpp"

#include <thread>

#include <gtest/gtest.h>
#include <poll.h>

namespace dyncal::drivers {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

TEST(StopSignal, IsNotRaisedUntilSomebodyRaisesIt) {
  StopSignal stop;
  EXPECT_FALSE(stop.raised());
  stop.raise();
  EXPECT_TRUE(stop.raised());
}

TEST(StopSignal, StaysRaisedForEveryLaterWait) {
  StopSignal stop;
  stop.raise();
  stop.raise();
  EXPECT_TRUE(stop.wait_for(seconds(3600)));
  EXPECT_TRUE(stop.wait_for(seconds(3600)));
  pollfd watched{stop.descriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&watched, 1, -1), 1);
}

TEST(StopSignal, EndsAWaitOfAnotherThread) {
  StopSignal stop;
  std::jthread stopper([&] { stop.raise(); });
  EXPECT_TRUE(stop.wait_for(seconds(3600)));
}

TEST(StopSignal, WaitsAsLongAsItWasTold) {
  const StopSignal stop;
  const auto begin = Clock::now();
  EXPECT_FALSE(stop.wait_for(nanoseconds(1'500'000)));
  EXPECT_GE(Clock::now() - begin, nanoseconds(1'500'000));
  EXPECT_FALSE(stop.wait_for(seconds(-1)));
}

} // namespace
} // namespace dyncal::drivers
