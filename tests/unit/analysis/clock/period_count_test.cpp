#include "analysis/clock/period_count.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double period_ns = 996'960.0;

std::int64_t stamp_of(int sample) {
  return std::llround(period_ns * sample);
}

PeriodCount settled(PeriodCount periods) {
  periods.finish();
  return periods;
}

TEST(PeriodCount, GoesAcrossSamplesThatTheNumberingShowsToBeMissing) {
  PeriodCount periods;
  for (int i = 0; i < 1000; ++i) {
    if (i % 10 != 3) {
      periods.add(static_cast<std::uint64_t>(i), stamp_of(i));
    }
  }
  EXPECT_EQ(periods.periods(), 999U);
  EXPECT_DOUBLE_EQ(periods.mean_ns(), period_ns);
  EXPECT_EQ(periods.unnumbered(), 0U);
}

TEST(PeriodCount, FindsWhatIsMissingWithoutNumbers) {
  PeriodCount periods;
  std::mt19937 random(1);
  std::normal_distribution<double> noise_ns(0.0, 20.0);
  std::uint64_t number = 0;
  std::uint64_t missing = 0;
  for (int i = 0; i < 10'000; ++i) {
    if (random() % 10 == 0 && i > 0 && i < 9999) {
      ++missing;
      continue;
    }
    const double noise = i == 0 || i == 9999 ? 0.0 : noise_ns(random);
    periods.add(number++, stamp_of(i) + std::llround(noise));
  }
  EXPECT_EQ(periods.periods(), 9999U);
  EXPECT_NEAR(periods.mean_ns(), period_ns, 1e-4);
  EXPECT_EQ(periods.unnumbered(), missing);
  std::uint64_t in_gaps = 0;
  for (const UnnumberedGap& gap : periods.take_gaps()) {
    in_gaps += gap.missing;
    EXPECT_NEAR(static_cast<double>(gap.after_ns - gap.before_ns),
                period_ns * static_cast<double>(gap.missing + 1), 200.0);
  }
  EXPECT_EQ(in_gaps, missing);
  EXPECT_TRUE(periods.take_gaps().empty());
}

TEST(PeriodCount, IsNotMovedByDuplicateAndBackwardStamps) {
  PeriodCount periods;
  for (int i = 0; i < 1000; ++i) {
    const bool duplicate = i % 50 == 20, backward = i % 50 == 40;
    periods.add(static_cast<std::uint64_t>(i), duplicate  ? stamp_of(i - 1)
                                               : backward ? stamp_of(i - 1) - 300'000
                                                          : stamp_of(i));
  }
  EXPECT_EQ(periods.periods(), 999U);
  EXPECT_DOUBLE_EQ(periods.mean_ns(), period_ns);
  EXPECT_EQ(periods.unnumbered(), 0U);
  EXPECT_EQ(periods.stretches(), 1U);
}

TEST(PeriodCount, LeavesOutAJumpOfTheClock) {
  PeriodCount periods;
  for (int i = 0; i < 1000; ++i) {
    periods.add(static_cast<std::uint64_t>(i), stamp_of(i) + (i < 500 ? 0 : 123'456'789'012));
  }
  EXPECT_EQ(periods.stretches(), 2U);
  EXPECT_NEAR(periods.mean_ns(), period_ns, 0.01);
  EXPECT_EQ(periods.unnumbered(), 0U);
}

TEST(PeriodCount, CountsNothingWhereThereIsNoPeriod) {
  PeriodCount periods;
  std::mt19937 random(2);
  std::int64_t stamp_ns = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    periods.add(i, stamp_ns += 1 + random() % 1'000'000);
  }
  EXPECT_FALSE(periods.knows_period());
  EXPECT_EQ(periods.periods(), 0U);
}

TEST(PeriodCount, LearnsFromAFewWhenThereAreNoMore) {
  PeriodCount periods;
  for (const int i : {0, 1, 2, 5, 6}) {
    periods.add(static_cast<std::uint64_t>(i < 3 ? i : i - 2), stamp_of(i));
  }
  EXPECT_EQ(periods.periods(), 0U);
  EXPECT_EQ(settled(periods).periods(), 6U);
  EXPECT_EQ(settled(periods).unnumbered(), 2U);
}

} // namespace
} // namespace dyncal::analysis
