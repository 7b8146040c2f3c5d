#include "analysis/clock/temperature_relation.hpp"

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(TemperatureRelation, FindsASlope) {
  TemperatureRelation relation(100, 1000);
  for (int i = 0; i < 500; ++i) {
    relation.add(20.0 + 0.01 * i, 1'000'000 + 3 * i);
  }
  EXPECT_NEAR(relation.correlation(), 1.0, 1e-12);
  EXPECT_NEAR(relation.slope_ns_per_degc(), 300.0, 1e-8);
}

TEST(TemperatureRelation, IsZeroWhereNothingVaries) {
  TemperatureRelation relation(100, 1000);
  EXPECT_EQ(relation.correlation(), 0.0);
  relation.add(20.0, 1000);
  relation.add(20.0, 1010);
  EXPECT_EQ(relation.correlation(), 0.0);
  EXPECT_EQ(relation.slope_ns_per_degc(), 0.0);
}

TEST(TemperatureRelation, StaysWithinItsBounds) {
  TemperatureRelation relation(8, 50);
  for (int i = 0; i < 1000; ++i) {
    relation.add(-5.0 + 0.05 * i, 1000 + i % 3);
  }
  const auto bins = relation.bins();
  ASSERT_FALSE(bins.empty());
  EXPECT_LE(bins.size(), 8u);
  std::uint64_t count = 0;
  for (const TemperatureBin& bin : bins) {
    count += bin.count;
    EXPECT_NEAR(bin.mean_interval_ns, 1001.0, 0.1);
    EXPECT_NEAR(bin.sd_interval_ns, 0.82, 0.05);
  }
  EXPECT_EQ(count, 1000u);
  EXPECT_GE(relation.pair_intervals_ns().size(), 25u);
  EXPECT_LE(relation.pair_intervals_ns().size(), 50u);
  EXPECT_EQ(relation.pair_intervals_ns().size(), relation.pair_temperatures_degc().size());
}

} // namespace
} // namespace dyncal::analysis
