#include "drivers/sample_rate.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers {
namespace {

TEST(SampleRate, IsTheFractionThatTheDecimalTextMeans) {
  EXPECT_EQ(sample_rate_from_hz(51200.0)->numerator, 51200);
  EXPECT_EQ(sample_rate_from_hz(51200.0)->denominator, 1);
  EXPECT_EQ(sample_rate_from_hz(1003.05)->numerator, 20061);
  EXPECT_EQ(sample_rate_from_hz(1003.05)->denominator, 20);
  EXPECT_EQ(sample_rate_from_hz(0.1)->numerator, 1);
  EXPECT_EQ(sample_rate_from_hz(0.1)->denominator, 10);
}

TEST(SampleRate, RefusesWhatNoInstrumentHas) {
  EXPECT_FALSE(sample_rate_from_hz(0.0));
  EXPECT_FALSE(sample_rate_from_hz(-5.0));
  EXPECT_FALSE(sample_rate_from_hz(1e12));
  EXPECT_FALSE(sample_rate_from_hz(1.0 / 3.0));
}

TEST(SampleRate, GivesStampsWithoutAccumulatedRounding) {
  const RegularClock clock = sample_rate_from_hz(51200.0)->clock(7);
  EXPECT_EQ(clock.stamp_ns(0), 7);
  EXPECT_EQ(clock.stamp_ns(1), 7 + 19531); // 19531.25
  EXPECT_EQ(clock.stamp_ns(2), 7 + 39063); // 39062.5, half up
  EXPECT_EQ(clock.stamp_ns(51200ULL * 86400ULL * 365ULL), 7 + 86400LL * 365LL * 1'000'000'000LL);
}

} // namespace
} // namespace dyncal::drivers
