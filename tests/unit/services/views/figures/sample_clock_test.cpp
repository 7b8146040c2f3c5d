#include "services/views/figures/sample_clock.hpp"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/views/figures/regular_intervals.hpp"
#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr double tick_s = 1 / 108e6;
constexpr double tick_ns = 1e9 * tick_s;

using analysis::IntervalHistogramBin;
using analysis::SampleClockStatistics;

IntervalHistogramBin count_of(std::int64_t ticks, std::uint64_t count) {
  return {ticks, static_cast<double>(ticks) * tick_ns, count};
}

SampleClockStatistics histogram_of(std::vector<IntervalHistogramBin> counts) {
  SampleClockStatistics clock;
  clock.tick_s = tick_s;
  clock.histogram = std::move(counts);
  return clock;
}

// Besides the bars: the background, the background and frame of the panel, and its clip.
std::size_t bars_of(const Figure& figure) {
  return count_elements(figure.svg(), "rect") - 4;
}

TEST(IntervalHistogram, HasABarForEveryTickOfANarrowDistribution) {
  const auto figure = interval_histogram_figure(
      {"intervals"},
      histogram_of({count_of(107670, 1), count_of(107671, 3000), count_of(107673, 20)}), "h");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_EQ(bars_of(figure), 3U);
  EXPECT_THAT(texts_of(figure.svg()), Contains(HasSubstr("= 1 tick")));
}

TEST(IntervalHistogram, MergesWholeTicksOfAWideDistribution) {
  std::vector<IntervalHistogramBin> counts;
  for (std::int64_t tick = 52000; tick < 53000; ++tick) {
    counts.push_back(count_of(tick, 2));
  }
  const auto figure = interval_histogram_figure({"intervals"}, histogram_of(counts), "h");
  EXPECT_EQ(bars_of(figure), 84U); // 1000 ticks, 12 a bin
  EXPECT_THAT(texts_of(figure.svg()), Contains(HasSubstr("= 12 ticks")));
  EXPECT_THAT(texts_of(figure.svg()), Contains(HasSubstr("2\u202f000 intervals")));
}

TEST(IntervalHistogram, HasNoBarForATickThatDidNotOccur) {
  EXPECT_EQ(bars_of(interval_histogram_figure(
                {"intervals"}, histogram_of({count_of(100, 5), count_of(101, 0), count_of(102, 5)}),
                "h")),
            2U);
}

TEST(IntervalHistogram, CountsWhatALostSampleMadeInsteadOfShowingIt) {
  const auto figure = interval_histogram_figure(
      {"intervals"}, histogram_of({count_of(107671, 3000), count_of(2 * 107671, 2)}), "h");
  EXPECT_EQ(bars_of(figure), 1U);
  EXPECT_THAT(texts_of(figure.svg()), Contains(HasSubstr("2 beyond the axis")));
  EXPECT_THAT(figure.csv, ContainsRegex("\n215342,[0-9.]+,2\n"));
}

TEST(IntervalHistogram, IsDrawnWhenThereIsNothingOrNothingVaries) {
  const std::vector<std::vector<IntervalHistogramBin>> degenerate = {
      {}, {count_of(1, 0)}, {count_of(0, 7)}, {count_of(107671, 1)}, {count_of(107671, 1000000)}};
  for (const auto& counts : degenerate) {
    EXPECT_EQ(problem_of(interval_histogram_figure({"intervals"}, histogram_of(counts), "h").svg()),
              "");
  }
  EXPECT_THAT(texts_of(interval_histogram_figure({}, {}, "h").svg()), Contains("no data"));
}

TEST(IntervalHistogram, NeedsNoTick) {
  SampleClockStatistics clock;
  clock.histogram = {{0, 996900.0, 3}, {0, 996950.0, 900}, {0, 997000.0, 5}};
  EXPECT_EQ(bars_of(interval_histogram_figure({"no tick"}, clock, "h")), 3U);
}

TEST(IntervalOverTemperature, ShowsEveryIntervalAndEveryBin) {
  SampleClockStatistics clock;
  for (int i = 0; i < 50; ++i) {
    clock.scatter_temperature_degc.push_back(27 + 0.02 * i);
    clock.scatter_interval_ns.push_back(996900 + 2 * i);
  }
  clock.over_temperature = {{27.25, 996925, 15, 25}, {27.75, 996975, 15, 25}, {28.5, 0, 0, 0}};
  const auto figure = interval_over_temperature_figure({"t"}, clock, "t");
  EXPECT_EQ(problem_of(figure.svg()), "");
  std::size_t dots = 0;
  for (auto at = figure.svg().find("h0"); at != std::string::npos;
       at = figure.svg().find("h0", at + 1)) {
    ++dots;
  }
  EXPECT_EQ(dots, 50U);
  EXPECT_EQ(count_elements(figure.svg(), "circle"), 2U + 2U)
      << "two bins with a count, two in the legend";
  EXPECT_THAT(figure.csv, HasSubstr("kind,temperature_degc,interval_ns,sd_interval_ns,count\n"));
}

TEST(IntervalOverTemperature, IsDrawnWhenThereIsNothingOrNothingVaries) {
  EXPECT_EQ(problem_of(interval_over_temperature_figure({}, {}, "t").svg()), "");
  SampleClockStatistics equal;
  equal.scatter_temperature_degc = {28, 28};
  equal.scatter_interval_ns = {5e5, 5e5};
  EXPECT_EQ(problem_of(interval_over_temperature_figure({"t"}, equal, "t").svg()), "");
  SampleClockStatistics uneven;
  uneven.scatter_temperature_degc = {28, 29};
  uneven.scatter_interval_ns = {5e5};
  EXPECT_EQ(problem_of(interval_over_temperature_figure({"t"}, uneven, "t").svg()), "");
}

TEST(IntervalOverTime, ShowsEveryIntervalOfTheCloseUp) {
  SampleClockStatistics clock;
  clock.close_up_first_time_s = 0.33;
  for (int i = 0; i < 100; ++i) {
    clock.over_time.push_back({0.01 * i, 484900, i % 40 == 0 ? 489200.0 : 485100.0, 485000});
  }
  for (int i = 0; i < 40; ++i) {
    clock.close_up_ns.push_back(i == 20 ? 489200 : (i == 21 ? 480800 : 485000));
  }
  const auto figure = interval_over_time_figure({"bma280"}, clock, "time");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_EQ(count_elements(figure.svg(), "circle"), 40U + 1);
  EXPECT_THAT(texts_of(figure.svg()), Contains("488"));
  EXPECT_THAT(figure.csv, HasSubstr("kind,time_s,minimum_ns,mean_ns,maximum_ns\n"));
}

TEST(IntervalOverTime, IsNotFlattenedByALostSample) {
  SampleClockStatistics clock;
  for (int i = 0; i < 100; ++i) {
    clock.over_time.push_back({0.01 * i, 484990, i == 50 ? 970000.0 : 485010.0, 485000});
  }
  const auto texts = texts_of(interval_over_time_figure({"bma280"}, clock, "time").svg());
  EXPECT_THAT(texts, Contains("485.000"));
  EXPECT_THAT(texts, Contains(HasSubstr("in 1 of 100 stretches")));
}

TEST(IntervalOverTime, IsDrawnWhenThereIsNothingOrOnePoint) {
  EXPECT_EQ(problem_of(interval_over_time_figure({}, {}, "time").svg()), "");
  SampleClockStatistics one;
  one.over_time = {{0, 1e6, 1e6, 1e6}};
  one.close_up_ns = {1e6};
  EXPECT_EQ(problem_of(interval_over_time_figure({"one"}, one, "time").svg()), "");
}

TEST(RegularIntervals, AreThoseWithinHalfOfTheMedian) {
  const RegularIntervals regular({{1000, 10}, {2000, 1}, {5, 1}});
  EXPECT_TRUE(regular.contain(1000));
  EXPECT_TRUE(regular.contain(1499));
  EXPECT_FALSE(regular.contain(2000));
  EXPECT_FALSE(regular.contain(5));
}

} // namespace
} // namespace dyncal::inline views::figures
