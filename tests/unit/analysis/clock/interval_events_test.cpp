#include "analysis/clock/interval_events.hpp"

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr UsualInterval usual{1000.0, 5.0};

IntervalVerdict verdict_on(const std::vector<std::int64_t>& lengths, std::size_t max_events = 100) {
  IntervalEventCollector collector;
  std::int64_t begin_ns = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    collector.add({i, i, begin_ns, lengths[i], i > 0}, usual);
    begin_ns += lengths[i];
  }
  return collector.judge(usual, 0, max_events);
}

TEST(IntervalEvents, EachKindIsNamed) {
  const IntervalVerdict verdict =
      verdict_on({1000, -20, 1000, 3, 1000, 3002, 1000, 1060, 938, 1000, 1100, 1000});
  ASSERT_EQ(verdict.events.size(), 5u);
  EXPECT_EQ(verdict.events[0].kind, "backward");
  EXPECT_EQ(verdict.events[1].kind, "duplicate");
  EXPECT_EQ(verdict.events[2].kind, "gap");
  EXPECT_EQ(verdict.events[2].missing, 2u);
  EXPECT_EQ(verdict.events[3].kind, "pair");
  EXPECT_EQ(verdict.events[3].sample, 7u);
  EXPECT_EQ(verdict.events[3].size_ns, 60.0);
  EXPECT_EQ(verdict.events[4].kind, "step");
  EXPECT_EQ(verdict.pair_count, 1u);
}

TEST(IntervalEvents, WhatIsUsualIsNotAnEvent) {
  const IntervalVerdict verdict = verdict_on({1000, 1029, 971, 1000});
  EXPECT_EQ(verdict.event_count, 0u);
  EXPECT_TRUE(verdict.unusual_lengths_ns.empty());
}

TEST(IntervalEvents, AllAreCountedAlsoWhenFewAreListed) {
  const IntervalVerdict verdict = verdict_on({1000, 1100, 1000, 1100, 1000, 1100, 1000}, 2);
  EXPECT_EQ(verdict.events.size(), 2u);
  EXPECT_EQ(verdict.event_count, 3u);
}

TEST(IntervalEvents, RegularPairsHaveAPeriod) {
  std::vector<std::int64_t> lengths;
  for (int pair = 0; pair < 8; ++pair) {
    lengths.insert(lengths.end(), 20, 1000);
    lengths.push_back(1100);
    lengths.push_back(900);
  }
  const IntervalVerdict verdict = verdict_on(lengths);
  EXPECT_EQ(verdict.pair_count, 8u);
  EXPECT_EQ(verdict.pair_period_samples, 22.0);
  EXPECT_NEAR(verdict.pair_period_s, 22e-6, 1e-15);
  EXPECT_NEAR(verdict.pair_regularity, 1.0, 1e-12);
}

} // namespace
} // namespace dyncal::analysis
