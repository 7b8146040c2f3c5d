#include "services/views/signals/trace.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

// 50 kS/s for so many seconds.
ChannelRing make_ring(double seconds, const std::function<double(std::size_t)>& value) {
  ChannelRing ring;
  const auto count = static_cast<std::size_t>(seconds * 50'000.0);
  constexpr std::size_t block = 1000;
  for (std::size_t first = 0; first < count; first += block) {
    std::vector<std::int64_t> stamps_ns;
    std::vector<double> values;
    for (std::size_t i = first; i < first + block; ++i) {
      stamps_ns.push_back(static_cast<std::int64_t>(i) * 20'000);
      values.push_back(value(i));
    }
    ring.push(stamps_ns, values, false, 1'000'000'000);
  }
  return ring;
}

double highest(const Trace& trace) {
  double value = -1e300;
  for (const TraceColumn& column : trace.columns) {
    value = std::max(value, column.maximum);
  }
  return value;
}

TEST(Trace, KeepsThePeakOfOneSampleAtEveryWidth) {
  // 777'777 of 1'500'000 samples: in the ring's milliseconds only.
  const auto ring = make_ring(
      30.0, [](std::size_t i) { return i == 777'777 ? 9.0 : std::sin(static_cast<double>(i)); });
  for (const std::size_t columns : {100U, 999U, 1000U, 4000U}) {
    const Trace trace = make_trace(ring, 20.0, columns, {});
    EXPECT_LE(trace.columns.size(), columns);
    EXPECT_EQ(highest(trace), 9.0) << columns;
    EXPECT_EQ(trace.level_peak, 9.0);
  }
  const Trace later = make_trace(ring, 10.0, 1000, {});
  EXPECT_LT(highest(later), 1.01) << "the peak is older than the window";
}

TEST(Trace, IsMadeOfSamplesWhereColumnsAreNarrow) {
  const auto ring = make_ring(2.0, [](std::size_t i) { return i == 99'990 ? 5.0 : 0.0; });
  const Trace trace = make_trace(ring, 1.0, 4000, {});
  ASSERT_GT(trace.columns.size(), 3900U);
  const auto peak = std::max_element(
      trace.columns.begin(), trace.columns.end(),
      [](const TraceColumn& a, const TraceColumn& b) { return a.maximum < b.maximum; });
  EXPECT_EQ(peak->maximum, 5.0);
  EXPECT_NEAR(peak->time_s, 1.0 - 9 * 20e-6, 0.5e-3);
}

TEST(Trace, GivesTheLevelAboutTheMeanAndCountsTheEndsOfTheRange) {
  const auto ring = make_ring(2.0, [](std::size_t i) {
    return 3.0 + std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 500.0);
  });
  const Trace trace = make_trace(ring, 1.0, 100, {-4.0, 4.0});
  EXPECT_NEAR(trace.level_rms, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(trace.level_peak, 4.0, 1e-12);
  EXPECT_EQ(trace.over_range, 100U) << "one sample of each of 100 periods is at the end";
  EXPECT_NEAR(trace.rate_hz, 50'000.0, 1e-6);
}

TEST(Trace, ShowsGapsAndHasNothingOfAnEmptyRing) {
  ChannelRing ring;
  EXPECT_TRUE(make_trace(ring, 1.0, 100, {}).columns.empty());
  const std::vector<double> ones(10, 1.0);
  std::vector<std::int64_t> stamps_ns(10);
  for (std::int64_t i = 0; i < 10; ++i) {
    stamps_ns[static_cast<std::size_t>(i)] = i * 10'000'000;
  }
  ring.push(stamps_ns, ones, false, 0);
  for (std::int64_t& stamp_ns : stamps_ns) {
    stamp_ns += 500'000'000;
  }
  ring.push(stamps_ns, ones, true, 0);
  const Trace trace = make_trace(ring, 1.0, 100, {});
  ASSERT_EQ(trace.gaps.size(), 1U);
  EXPECT_NEAR(trace.gaps[0].second - trace.gaps[0].first, 0.41, 1e-9);
}

} // namespace
} // namespace dyncal::inline views
