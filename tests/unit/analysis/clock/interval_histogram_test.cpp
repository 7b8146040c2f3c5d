#include "analysis/clock/interval_histogram.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// Counts over intervals of whole ticks of 10 ns, about 1000 ns.
IntervalDistribution on_lattice(double first, double second) {
  std::vector<IntervalDistribution::Entry> entries;
  for (int tick = 80; tick <= 120; ++tick) {
    const double count = 1e4 * (std::exp(-0.5 * std::pow((tick - first) / 2.0, 2)) +
                                std::exp(-0.5 * std::pow((tick - second) / 2.0, 2)));
    entries.emplace_back(10 * tick, static_cast<std::uint64_t>(count) + 1);
  }
  return IntervalDistribution(entries);
}

TEST(IntervalHistogram, BinsAreWholeTicks) {
  const IntervalHistogram histogram = interval_histogram(on_lattice(100, 100), 10.0, 20.0);
  EXPECT_EQ(histogram.bin_ns, 10.0);
  ASSERT_EQ(histogram.bins.size(), 41u);
  EXPECT_EQ(histogram.bins.front().ticks, 80);
  EXPECT_EQ(histogram.bins.front().interval_ns, 800.0);
}

TEST(IntervalHistogram, TheLatticeShowsAtItsTickAlone) {
  const IntervalDistribution distribution = on_lattice(100, 100);
  EXPECT_NEAR(lattice_statistic(distribution, 10.0), 1.0, 1e-9);
  EXPECT_LT(lattice_statistic(distribution, 13.7), 0.2);
}

TEST(IntervalHistogram, TwoPeaksAreTwoModesAndOneIsOne) {
  const auto two = interval_modes_ns(interval_histogram(on_lattice(92, 108), 10.0, 80.0));
  ASSERT_EQ(two.size(), 2u);
  EXPECT_NEAR(two[0], 920.0, 10.0);
  EXPECT_NEAR(two[1], 1080.0, 10.0);
  EXPECT_EQ(interval_modes_ns(interval_histogram(on_lattice(100, 100), 10.0, 20.0)).size(), 1u);
}

} // namespace
} // namespace dyncal::analysis
