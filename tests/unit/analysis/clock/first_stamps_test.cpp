#include "analysis/clock/first_stamps.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

std::vector<TimedSample> ticked(double period_ns, std::int64_t tick_ns, int count = 65) {
  std::vector<TimedSample> samples;
  for (int i = 0; i < count; ++i) {
    const std::int64_t ticks =
        std::llround(std::floor(period_ns * i / static_cast<double>(tick_ns)));
    samples.push_back({static_cast<std::uint64_t>(i), ticks * tick_ns});
  }
  return samples;
}

TEST(FirstStamps, IntervalsThatAreAlikeTellOneInterval) {
  EXPECT_EQ(alike_interval_ns(ticked(1'003'009.0, 1'000'000)), 1'000'000);
  EXPECT_EQ(alike_interval_ns(ticked(1'003'009.37, 1)), std::nullopt);
  std::vector<TimedSample> one_is_missing = ticked(1'003'009.0, 1'000'000);
  one_is_missing.erase(one_is_missing.begin() + 30);
  EXPECT_EQ(alike_interval_ns(one_is_missing), 1'000'000);
  EXPECT_EQ(alike_interval_ns({}), std::nullopt);
}

TEST(FirstStamps, TicksAreThoseOfMoreThanAQuarterOfAPeriod) {
  for (const double periods : {0.3, 0.55, 1.3, 2.6, 3.7}) {
    const auto ticks = ticks_of(ticked(periods * 1e6, 1'000'000));
    ASSERT_TRUE(ticks) << periods;
    EXPECT_EQ(ticks->tick_ns, 1'000'000);
    EXPECT_NEAR(ticks->line.period_ns(), periods * 1e6, 1e6 / 32.0) << periods;
  }
  EXPECT_FALSE(ticks_of(ticked(5.3e6, 1'000'000)));
  EXPECT_FALSE(ticks_of(ticked(1'003'009.37, 1)));
}

// Eight at once from a FIFO are no line, for all that their stamps are whole ticks.
TEST(FirstStamps, BatchesLieOnNoLine) {
  std::vector<TimedSample> samples = ticked(1'230'009.0, 1'000'000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].stamp_ns = samples[i / 8 * 8].stamp_ns;
  }
  EXPECT_FALSE(ticks_of(samples));
  EXPECT_FALSE(alike_interval_ns(samples));
}

TEST(FirstStamps, APeriodIsThatOfNineInTenIntervals) {
  std::vector<TimedSample> samples = ticked(1'003'009.37, 1);
  const auto period = period_of(samples);
  ASSERT_TRUE(period);
  EXPECT_NEAR(period->period_ns, 1'003'009.0, 2.0);
  for (std::size_t i = 0; i < samples.size(); i += 4) {
    samples[i].stamp_ns += 400'000;
  }
  EXPECT_FALSE(period_of(samples));
  EXPECT_FALSE(period_of({}));
}

} // namespace
} // namespace dyncal::analysis
