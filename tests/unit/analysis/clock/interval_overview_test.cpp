#include "analysis/clock/interval_overview.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr UsualInterval usual{1000.0, 5.0};

SampleInterval interval(std::uint64_t i, std::int64_t length_ns) {
  return {i, i, static_cast<std::int64_t>(1000 * i), length_ns, i > 0};
}

TEST(IntervalOverview, KeepsExtremesAndMeanInABoundedNumberOfBuckets) {
  IntervalOverview overview(10);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    overview.add(interval(i, i == 777 ? 1500 : 1000));
  }
  const auto buckets = overview.buckets(0);
  ASSERT_GE(buckets.size(), 5u);
  ASSERT_LE(buckets.size(), 10u);
  EXPECT_EQ(buckets.front().time_s, 0.0);
  EXPECT_TRUE(std::is_sorted(buckets.begin(), buckets.end(),
                             [](const auto& a, const auto& b) { return a.time_s < b.time_s; }));
  EXPECT_EQ(std::count_if(buckets.begin(), buckets.end(),
                          [](const auto& bucket) { return bucket.maximum_ns == 1500.0; }),
            1);
  for (const IntervalBucket& bucket : buckets) {
    EXPECT_EQ(bucket.minimum_ns, 1000.0);
    EXPECT_GE(bucket.mean_ns, 1000.0);
    EXPECT_LT(bucket.mean_ns, 1010.0);
  }
}

TEST(IntervalCloseUp, ShowsTheSurroundingsOfTheFirstPair) {
  IntervalCloseUp close_up(3);
  for (std::uint64_t i = 0; i < 50; ++i) {
    const bool late = i == 20 || i == 40, early = i == 21 || i == 41;
    close_up.add(interval(i, late ? 1100 : early ? 901 : 1000), usual);
  }
  const std::vector<double> lengths = close_up.lengths_ns();
  ASSERT_FALSE(lengths.empty());
  EXPECT_LE(lengths.size(), 8u);
  EXPECT_EQ(std::count(lengths.begin(), lengths.end(), 1100.0), 1);
  EXPECT_EQ(std::count(lengths.begin(), lengths.end(), 901.0), 1);
  EXPECT_EQ(close_up.first_begin_ns(), 17'000);
}

TEST(IntervalCloseUp, IsEmptyWithoutAPair) {
  IntervalCloseUp close_up(3);
  for (std::uint64_t i = 0; i < 50; ++i) {
    close_up.add(interval(i, 1000), usual);
  }
  EXPECT_TRUE(close_up.lengths_ns().empty());
}

} // namespace
} // namespace dyncal::analysis
