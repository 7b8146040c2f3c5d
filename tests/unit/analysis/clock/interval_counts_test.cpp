#include "analysis/clock/interval_counts.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

IntervalCounts counts_of(const std::vector<std::int64_t>& lengths, std::size_t max_distinct) {
  IntervalCounts counts(max_distinct);
  for (const std::int64_t length : lengths) {
    counts.add(length);
  }
  return counts;
}

TEST(IntervalCounts, GiveTheStatisticsOfTheIntegers) {
  const IntervalCounts counts = counts_of({10, 12, 12, 14, 17}, 100);
  EXPECT_EQ(counts.minimum_ns(), 10);
  EXPECT_EQ(counts.maximum_ns(), 17);
  EXPECT_EQ(counts.sums().mean_ns(), 13.0);
  EXPECT_DOUBLE_EQ(counts.sums().sd_ns(), std::sqrt((9.0 + 1.0 + 1.0 + 1.0 + 16.0) / 4.0));
  const IntervalDistribution distribution = counts.distribution();
  EXPECT_EQ(distribution.count(), 5u);
  EXPECT_EQ(distribution.quantile(0.5), 12.0);
  EXPECT_EQ(distribution.quantile(0.0), 10.0);
  EXPECT_EQ(distribution.quantile(1.0), 17.0);
  EXPECT_EQ(distribution.quantile(0.875), 15.5); // half way between 14 and 17
  EXPECT_EQ(distribution.median_absolute_deviation(), 2.0);
}

TEST(IntervalCounts, RemovedIntervalsLeaveNoTrace) {
  IntervalSums sums = counts_of({10, 12, 400}, 100).sums();
  sums.remove(400);
  EXPECT_EQ(sums.mean_ns(), 11.0);
  EXPECT_DOUBLE_EQ(sums.sd_ns(), std::sqrt(2.0));
}

TEST(IntervalCounts, BeyondTheBoundOnlyTheCountsGetCoarser) {
  std::vector<std::int64_t> lengths;
  for (std::int64_t i = 0; i < 1000; ++i) {
    lengths.push_back(1'000'000 + i);
  }
  const IntervalCounts exact = counts_of(lengths, 2000), coarse = counts_of(lengths, 100);
  EXPECT_EQ(coarse.sums().mean_ns(), exact.sums().mean_ns());
  EXPECT_EQ(coarse.sums().sd_ns(), exact.sums().sd_ns());
  EXPECT_EQ(coarse.minimum_ns(), 1'000'000);
  EXPECT_EQ(coarse.distribution().count(), 1000u);
  EXPECT_LE(coarse.distribution().entries().size(), 100u);
  EXPECT_NEAR(coarse.distribution().quantile(0.5), exact.distribution().quantile(0.5), 16.0);
}

} // namespace
} // namespace dyncal::analysis
