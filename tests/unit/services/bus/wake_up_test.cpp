#include <gtest/gtest.h>
#include <thread>

#include "services/bus/bus.hpp"

namespace dyncal::bus {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(WakeUp, RemembersARingThatCameBeforeTheWait) {
  WakeUp bell;
  bell.ring();
  bell.ring();
  EXPECT_TRUE(bell.wait_until(Clock::now()));
  EXPECT_FALSE(bell.wait_until(Clock::now()));
}

TEST(WakeUp, EndsAWaitFromAnotherThread) {
  WakeUp bell;
  std::thread other([&] { bell.ring(); });
  EXPECT_TRUE(bell.wait_until(Clock::now() + 30s));
  other.join();
}

TEST(WakeUp, SaysWhenTheTimeRanOut) {
  WakeUp bell;
  const auto deadline = Clock::now() + 5ms;
  EXPECT_FALSE(bell.wait_until(deadline));
  EXPECT_GE(Clock::now(), deadline);
}

} // namespace
} // namespace dyncal::bus
