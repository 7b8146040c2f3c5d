#include "services/bus/memory/stepped_clock.hpp"

#include <gtest/gtest.h>
#include <stdexcept>
#include <vector>

namespace dyncal::bus {
namespace {

using namespace std::chrono_literals;

TEST(SteppedClock, MovesToTheDeadlineWhenNothingRings) {
  SteppedClock clock;
  WakeUp bell;
  const auto began = clock.now();
  const auto began_utc_ns = clock.utc_now_ns();
  EXPECT_FALSE(clock.wait(bell, began + 5s));
  EXPECT_EQ(clock.now() - began, 5s);
  EXPECT_EQ(clock.utc_now_ns() - began_utc_ns, 5'000'000'000);
  EXPECT_FALSE(clock.wait(bell, began)); // never back
  EXPECT_EQ(clock.elapsed(), 5s);
}

TEST(SteppedClock, StopsWhereAnActionRings) {
  SteppedClock clock;
  WakeUp bell;
  clock.at(2s, [&] { bell.ring(); });
  EXPECT_TRUE(clock.wait(bell, clock.now() + 5s));
  EXPECT_EQ(clock.elapsed(), 2s);
  bell.ring();
  EXPECT_TRUE(clock.wait(bell, clock.now() + 5s));
  EXPECT_EQ(clock.elapsed(), 2s);
}

TEST(SteppedClock, RunsActionsInTheOrderOfTheirTime) {
  SteppedClock clock;
  std::vector<int> order;
  clock.at(2s, [&] { order.push_back(2); });
  clock.at(1s, [&] {
    order.push_back(1);
    clock.at(0s, [&] { order.push_back(10); }); // late: at once
  });
  clock.at(2s, [&] { order.push_back(3); });
  clock.at(4s, [&] { order.push_back(4); });
  clock.advance(3s);
  EXPECT_EQ(order, (std::vector<int>{1, 10, 2, 3}));
  EXPECT_EQ(clock.elapsed(), 3s);
}

TEST(SteppedClock, RepeatsAnAction) {
  SteppedClock clock;
  std::vector<std::chrono::nanoseconds> times;
  clock.every(400ms, [&] { times.push_back(clock.elapsed()); });
  clock.advance(1s);
  EXPECT_EQ(times, (std::vector<std::chrono::nanoseconds>{400ms, 800ms}));
}

TEST(SteppedClock, EndsATestThatWaitsForever) {
  SteppedClock clock;
  EXPECT_THROW(clock.advance(2h), std::runtime_error);
}

} // namespace
} // namespace dyncal::bus
