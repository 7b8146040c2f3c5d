#include "services/bus/host_clocks/clock_offset.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace dyncal::inline host_clocks {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t ms = 1'000'000;
const OffsetTracker::Instant start{1h};

// An exchange with a clock that is `ahead`, which takes that long there and back.
ClockStamps exchange(std::int64_t ahead_ns, std::int64_t there_ns, std::int64_t back_ns) {
  const std::int64_t sent = 1'800'000'000'000'000'000;
  const std::int64_t received = sent + there_ns + ahead_ns;
  const std::int64_t answered = received + 5 * ms;
  return {sent, received, answered, answered + back_ns - ahead_ns};
}

TEST(ClockOffset, IsExactWhenBothDirectionsTakeTheSame) {
  const auto offset = clock_offset(exchange(3600'000 * ms, 2 * ms, 2 * ms));
  ASSERT_TRUE(offset);
  EXPECT_NEAR(offset->offset_s, 3600.0, 1e-9);
  EXPECT_NEAR(offset->bound_s, 0.002, 1e-9);
}

TEST(ClockOffset, IsWithinItsBoundWhateverTheDirectionsTake) {
  const auto slow_there = clock_offset(exchange(-300'000 * ms, 40 * ms, 0));
  const auto slow_back = clock_offset(exchange(-300'000 * ms, 0, 40 * ms));
  ASSERT_TRUE(slow_there && slow_back);
  EXPECT_NEAR(slow_there->offset_s, -300.0 + 0.020, 1e-9);
  EXPECT_NEAR(slow_back->offset_s, -300.0 - 0.020, 1e-9);
  EXPECT_NEAR(slow_there->bound_s, 0.020, 1e-9);
  EXPECT_NEAR(slow_back->bound_s, 0.020, 1e-9);
}

TEST(ClockOffset, IsNotTakenFromStampsThatCannotBe) {
  EXPECT_FALSE(clock_offset(exchange(0, -2 * ms, 1 * ms)));
  EXPECT_FALSE(clock_offset({0, 10, 5, 20})) << "answered before it came";
  constexpr auto far = std::numeric_limits<std::int64_t>::max();
  EXPECT_TRUE(clock_offset({0, far, far, ms})) << "absurd, but no overflow";
  EXPECT_FALSE(clock_offset({-far, far, far, far}));
}

TEST(OffsetTracker, TakesTheExchangeWithTheSmallestBound) {
  OffsetTracker tracker;
  EXPECT_FALSE(tracker.offset(start));
  tracker.add(exchange(100 * ms, 30 * ms, 0), start);
  tracker.add(exchange(100 * ms, 1 * ms, 1 * ms), start);
  tracker.add(exchange(100 * ms, 0, 50 * ms), start);
  ASSERT_TRUE(tracker.offset(start));
  EXPECT_NEAR(tracker.offset(start)->offset_s, 0.100, 1e-9);
  EXPECT_NEAR(tracker.offset(start)->bound_s, 0.001, 1e-9);
}

TEST(OffsetTracker, TrustsAnExchangeLessTheOlderItIs) {
  OffsetTracker tracker;
  tracker.add(exchange(0, 1 * ms, 1 * ms), start);
  EXPECT_NEAR(tracker.offset(start + 100s)->bound_s, 0.001 + 100 * OffsetTracker::max_drift, 1e-9);
  tracker.add(exchange(2 * ms, 4 * ms, 4 * ms), start + 100s); // a better one by now
  EXPECT_NEAR(tracker.offset(start + 100s)->offset_s, 0.002, 1e-9);
}

TEST(OffsetTracker, ForgetsWhatWasBeforeAClockWasSet) {
  OffsetTracker tracker;
  tracker.add(exchange(0, 1 * ms, 1 * ms), start);
  tracker.add(exchange(10'000 * ms, 5 * ms, 5 * ms), start + 1s);
  EXPECT_NEAR(tracker.offset(start + 1s)->offset_s, 10.0, 1e-9);
  EXPECT_NEAR(tracker.offset(start + 1s)->bound_s, 0.005, 1e-9);
}

TEST(OffsetTracker, KeepsTheNewestExchangesOnly) {
  OffsetTracker tracker;
  tracker.add(exchange(0, 0, 0), start);
  for (std::size_t i = 0; i < OffsetTracker::kept_exchanges; ++i) {
    tracker.add(exchange(0, 1 * ms, 1 * ms), start);
  }
  EXPECT_NEAR(tracker.offset(start)->bound_s, 0.001, 1e-9);
}

} // namespace
} // namespace dyncal::inline host_clocks
