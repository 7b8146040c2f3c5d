#include "analysis/clock/tick_line.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double tick_ns = 1e6;

std::int64_t stamp_of(double period_ns, std::uint64_t sample) {
  return std::llround(std::floor(period_ns * static_cast<double>(sample) / tick_ns) * tick_ns);
}

TEST(TickLine, TakesASampleClockAndLearnsItsPeriod) {
  for (const double period_ns : {0.41e6, 0.9987e6, 1'003'009.0, 1.62e6, 3.3e6}) {
    TickLine line(tick_ns, {0.1 * tick_ns, 4.0 * tick_ns});
    line.begin(0, 0);
    for (std::uint64_t i = 1; i < 5000; ++i) {
      ASSERT_TRUE(line.add(i, stamp_of(period_ns, i))) << period_ns << " at " << i;
    }
    EXPECT_NEAR(line.period_ns(), period_ns, tick_ns / 2000.0);
    EXPECT_LE(line.periods().min_ns, period_ns);
    EXPECT_GE(line.periods().max_ns, period_ns);
    EXPECT_NEAR(line.late_ns(5000, stamp_of(period_ns, 5000)), 0.0, 0.7 * tick_ns);
  }
}

TEST(TickLine, DoesNotTakeWhatIsAPeriodOff) {
  constexpr double period_ns = 1.62e6;
  TickLine line(tick_ns, {tick_ns, 2.0 * tick_ns});
  line.begin(0, 0);
  for (std::uint64_t i = 1; i < 500; ++i) {
    ASSERT_TRUE(line.add(i, stamp_of(period_ns, i)));
  }
  EXPECT_FALSE(line.admits(500, stamp_of(period_ns, 501)));
  EXPECT_FALSE(line.add(500, stamp_of(period_ns, 499)));
  EXPECT_TRUE(line.admits(501, stamp_of(period_ns, 501))); // nothing came of it
}

TEST(TickLine, FollowsAClockThatWanders) {
  TickLine line(tick_ns, {tick_ns, 2.0 * tick_ns});
  line.begin(0, 0);
  double true_ns = 0.0;
  for (std::uint64_t i = 1; i < 300'000; ++i) {
    true_ns += 1.3e6 * (1.0 + 2e-6 * std::sin(2e-5 * static_cast<double>(i)));
    ASSERT_TRUE(line.add(i, std::llround(std::floor(true_ns / tick_ns) * tick_ns))) << i;
  }
}

} // namespace
} // namespace dyncal::analysis
