#include "analysis/clock/sample_clock.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double tick_ns = 1e9 / 108e6;

std::vector<std::int64_t> stamps_of(const std::vector<std::int64_t>& intervals_ns,
                                    std::int64_t start_ns = 1'700'000'000'000'000'000) {
  std::vector<std::int64_t> stamps{start_ns};
  for (const std::int64_t interval : intervals_ns) {
    stamps.push_back(stamps.back() + interval);
  }
  return stamps;
}

SampleClockStatistics statistics_of(const std::vector<std::int64_t>& stamps,
                                    const SampleClockSettings& settings = {}) {
  SampleClock clock(settings);
  clock.push(0, stamps);
  return clock.statistics().value();
}

TEST(SampleClock, MeetsTheCheckVectorOfABma280) {
  std::ifstream file(DYNCAL_SHARED_DATA "/vectors/09_bma280_intervals.csv");
  if (!file) {
    GTEST_SKIP() << "the check vectors are not beside the source tree";
  }
  std::vector<std::int64_t> stamps;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    stamps.push_back(std::stoll(line));
  }
  SampleClockSettings settings;
  settings.tick_s = tick_ns * 1e-9;
  const SampleClockStatistics s = statistics_of(stamps, settings);
  EXPECT_EQ(s.intervals, 11999u);
  EXPECT_NEAR(s.mean_interval_s * 1e9 / 485000.04708725726, 1.0, 1e-15);
  EXPECT_NEAR(s.sd_s * 1e9 / 133.44282744934094, 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(s.minimum_s, 480787e-9);
  EXPECT_DOUBLE_EQ(s.maximum_s, 489213e-9);
  EXPECT_DOUBLE_EQ(s.median_s, 485000e-9);
  EXPECT_NEAR(s.mad_sd_s * 1e9, 1.4826 * 9.0, 1e-12);
  EXPECT_NEAR(s.core_mean_s * 1e9 / 485000.0472178193, 1.0, 1e-12);
  EXPECT_NEAR(s.core_sd_s * 1e9 / 12.5611976815343194967551363793, 1.0, 1e-12);
  ASSERT_EQ(s.events.size(), 6u);
  const std::vector<std::uint64_t> places{700, 2900, 5101, 7298, 9499, 11699};
  const std::vector<double> sizes{4213, 4213, 4194, 4185, 4204, 4195};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(s.events[i].kind, "pair");
    EXPECT_EQ(s.events[i].sample, places[i]);
    EXPECT_EQ(s.events[i].size_ns, sizes[i]);
  }
  EXPECT_EQ(s.pair_period_samples, 2200.0);
  EXPECT_NEAR(s.pair_period_s, 1.0670003890000002, 1e-12);
  EXPECT_GT(s.pair_regularity, 0.999);
  const std::vector<std::pair<std::int64_t, std::uint64_t>> expected{
      {51925, 1},    {51926, 4},    {51929, 1},    {52375, 3},    {52376, 38},
      {52377, 305},  {52378, 1202}, {52379, 2681}, {52380, 3496}, {52381, 2713},
      {52382, 1185}, {52383, 318},  {52384, 41},   {52385, 3},    {52386, 2},
      {52832, 1},    {52833, 2},    {52834, 1},    {52835, 2}};
  ASSERT_EQ(s.histogram.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(s.histogram[i].ticks, expected[i].first);
    EXPECT_EQ(s.histogram[i].count, expected[i].second);
  }
  EXPECT_GT(s.lattice_statistic, 0.9);
  ASSERT_FALSE(s.close_up_ns.empty());
  EXPECT_EQ(*std::max_element(s.close_up_ns.begin(), s.close_up_ns.end()), 489213.0);
}

TEST(SampleClock, QuantilesLieBetweenOrderStatistics) {
  const SampleClockStatistics s = statistics_of(stamps_of({10, 20, 30, 40}));
  EXPECT_DOUBLE_EQ(s.median_s, 25e-9);
  EXPECT_DOUBLE_EQ(s.quantile_01_s, 10.3e-9);
  EXPECT_DOUBLE_EQ(s.mad_sd_s, 1.4826 * 10e-9);
  EXPECT_NEAR(s.sd_s * 1e9, std::sqrt(500.0 / 3.0), 1e-12);
}

TEST(SampleClock, TellsEventsApart) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 12.0);
  std::vector<std::int64_t> intervals;
  for (int i = 0; i < 5000; ++i) {
    intervals.push_back(std::llround(1e6 + noise(random)));
  }
  intervals[1000] = 3'000'010; // two samples missing
  intervals[2000] = 3'000;     // the same sample twice
  intervals[2500] = 1'000'800; // late ...
  intervals[2501] = 999'210;   // ... and made good
  intervals[3000] = 1'300'000; // the clock was put forward
  intervals[3500] = -4'000;    // and back
  const SampleClockStatistics s = statistics_of(stamps_of(intervals));
  ASSERT_EQ(s.events.size(), 5u);
  EXPECT_EQ(s.events[0].kind, "gap");
  EXPECT_EQ(s.events[0].missing, 2u);
  EXPECT_EQ(s.events[1].kind, "duplicate");
  EXPECT_EQ(s.events[2].kind, "pair");
  EXPECT_EQ(s.events[2].sample, 2500u);
  EXPECT_EQ(s.events[3].kind, "step");
  EXPECT_NEAR(s.events[3].size_ns, 300'000.0, 5.0);
  EXPECT_EQ(s.events[4].kind, "backward");
  EXPECT_EQ(s.event_count, 5u);
  EXPECT_NEAR(s.core_sd_s * 1e9, 12.0, 0.4);
}

// A BMA280: every 2200 samples (+-2) one comes 4.2 us late.
TEST(SampleClock, FindsEveryLateSampleAndTheirPeriod) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 12.0);
  std::vector<std::int64_t> intervals;
  int expected = 0;
  for (int next = 900; intervals.size() < 400'000;) {
    intervals.push_back(std::llround(485'000.0 + noise(random)));
    if (static_cast<int>(intervals.size()) - 1 == next) {
      intervals.back() += 4200;
      intervals.push_back(std::llround(480'800.0 + noise(random)));
      ++expected;
      next += 2198 + static_cast<int>(random() % 5);
    }
  }
  const SampleClockStatistics s = statistics_of(stamps_of(intervals));
  EXPECT_EQ(s.pair_count, static_cast<std::uint64_t>(expected));
  EXPECT_NEAR(s.pair_period_samples, 2200.0, 1.0);
  EXPECT_NEAR(s.pair_period_s, 1.067, 0.001);
  EXPECT_EQ(s.close_up_ns.size(), 2u * SampleClockSettings{}.close_up + 1u);
}

TEST(SampleClock, PairsByChanceHaveNoPeriod) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 12.0);
  std::vector<std::int64_t> intervals;
  for (int i = 0; i < 200'000; ++i) {
    intervals.push_back(std::llround(1e6 + noise(random)));
  }
  for (int i = 0; i < 40; ++i) {
    const std::size_t place = 1 + random() % 199'990;
    intervals[place] += 1000;
    intervals[place + 1] -= 1000;
  }
  const SampleClockStatistics s = statistics_of(stamps_of(intervals));
  EXPECT_GT(s.pair_count, 30u);
  EXPECT_LT(s.pair_regularity, 0.6);
  EXPECT_EQ(s.pair_period_samples, 0.0);
}

TEST(SampleClock, LostAndUntrustedSamplesMakeNoInterval) {
  SampleClock clock;
  const std::vector<std::int64_t> first{0, 100, 200}, second{500, 600, 700, 800};
  clock.push(10, first);
  clock.push(15, second,
             std::vector<std::uint8_t>{0, 0, 1, 0}); // 13 and 14 are lost, 17 is not trusted
  const auto s = clock.statistics();
  ASSERT_TRUE(s.has_value());
  EXPECT_EQ(s->intervals, 3u);
  EXPECT_DOUBLE_EQ(s->mean_interval_s, 100e-9);
  EXPECT_EQ(s->lost, 2u);
  EXPECT_EQ(s->untrusted, 1u);
}

// A sensor of 1003.05 Hz with 1 % lost, with and without sample numbers.
TEST(SampleClock, MeanGoesAcrossLosses) {
  constexpr double interval_ns = 1e9 / 1003.05;
  for (const bool numbered : {true, false}) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise_ns(0.0, 20.0);
    SampleClock clock;
    std::uint64_t number = 0;
    std::uint64_t lost = 0;
    for (int i = 0; i < 30'000; ++i) {
      const double noise = noise_ns(random);
      if (i > 0 && i < 29'999 && random() % 100 == 0) {
        ++lost;
        continue;
      }
      const std::vector<std::int64_t> stamp{std::llround(interval_ns * i + noise)};
      clock.push(numbered ? static_cast<std::uint64_t>(i) : number++, stamp);
    }
    const auto s = clock.statistics();
    ASSERT_TRUE(s);
    EXPECT_GT(s->u_mean_interval_s, 0.0);
    EXPECT_LT(s->u_mean_interval_s, 40e-9 / 29'999);
    EXPECT_NEAR(s->mean_interval_s, interval_ns * 1e-9, 2.0 * s->u_mean_interval_s);
    EXPECT_NEAR(s->mean_rate_hz, 1003.05, 1e-5);
    EXPECT_EQ(s->lost, lost);
  }
}

TEST(SampleClock, KnowsNothingOfTheUncertaintyOfEqualIntervals) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 1000; ++i) {
    stamps.push_back(1'000'000LL * i);
  }
  const SampleClockStatistics s = statistics_of(stamps);
  EXPECT_EQ(s.mean_rate_hz, 1000.0);
  EXPECT_TRUE(std::isnan(s.u_mean_interval_s));
}

TEST(SampleClock, SaysNothingWithFewerThanTwoIntervals) {
  SampleClock clock;
  EXPECT_FALSE(clock.statistics().has_value());
  clock.push(0, std::vector<std::int64_t>{0, 100});
  EXPECT_FALSE(clock.statistics().has_value());
}

TEST(SampleClock, IsTheSameHoweverTheStreamWasCut) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 20.0);
  std::vector<std::int64_t> intervals;
  std::vector<double> temperatures;
  for (int i = 0; i < 20000; ++i) {
    const double temperature = 27.0 + 1e-4 * i;
    temperatures.push_back(temperature);
    intervals.push_back(std::llround(996'960.0 + 1.5 * (temperature - 28.0) + noise(random)));
  }
  intervals[7000] += 900;
  intervals[7001] -= 900;
  temperatures.push_back(29.0);
  const auto stamps = stamps_of(intervals);
  SampleClock whole, cut;
  whole.push(5, stamps, {}, temperatures);
  for (std::size_t i = 0; i < stamps.size(); i += 77) {
    const std::size_t n = std::min<std::size_t>(77, stamps.size() - i);
    cut.push(5 + i, std::span(stamps).subspan(i, n), {}, std::span(temperatures).subspan(i, n));
  }
  const auto a = whole.statistics(), b = cut.statistics();
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->sd_s, b->sd_s);
  EXPECT_EQ(a->temperature_slope_s_per_degc, b->temperature_slope_s_per_degc);
  EXPECT_EQ(a->close_up_ns, b->close_up_ns);
  EXPECT_EQ(a->scatter_interval_ns, b->scatter_interval_ns);
  ASSERT_EQ(a->allan.size(), b->allan.size());
  for (std::size_t i = 0; i < a->allan.size(); ++i) {
    EXPECT_EQ(a->allan[i].deviation, b->allan[i].deviation);
  }
  ASSERT_EQ(a->over_time.size(), b->over_time.size());
  EXPECT_LE(a->over_time.size(), SampleClockSettings{}.max_buckets);
}

// The clock model of an MPU-9250 (four preferred intervals that follow the temperature) as far as a
// test needs it.
TEST(SampleClock, DescribesTheClockOfThePaper) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  constexpr int samples = 400'000;
  const std::vector<double> levels{-39, -13, 13, 39}, centres{26.8, 27.9, 28.5, 28.95};
  std::size_t level = 0;
  double time_ns = 1.7e9;
  std::vector<std::int64_t> stamps;
  std::vector<double> temperatures;
  for (int i = 0; i < samples; ++i) {
    const double x = static_cast<double>(i) / samples;
    const double temperature =
        27.0 + 1.8 * (1.0 - std::exp(-3.0 * x)) + 0.15 * std::sin(14.0 * std::numbers::pi * x);
    if (uniform(random) < 0.02) {
      std::vector<double> weights;
      for (const double centre : centres) {
        weights.push_back(std::exp(-std::pow(temperature - centre, 2) / (2.0 * 0.35 * 0.35)) +
                          0.03);
      }
      level = static_cast<std::size_t>(
          std::discrete_distribution<int>(weights.begin(), weights.end())(random));
    }
    time_ns +=
        996955.15 + 0.835 * levels[level] + 1.5 * (temperature - 28.2) + 5.0 * normal(random);
    stamps.push_back(
        std::llround(std::floor((time_ns + 3.0 * normal(random)) / tick_ns) * tick_ns));
    temperatures.push_back(temperature);
  }
  SampleClock clock(
      {.nominal_rate_hz = 1000.0, .tick_s = tick_ns * 1e-9, .stamp_uncertainty_s = 150e-9});
  clock.push(0, stamps, {}, temperatures);
  const auto s = clock.statistics();
  ASSERT_TRUE(s.has_value());
  EXPECT_NEAR(s->mean_interval_s, 996.96e-6, 0.02e-6);
  EXPECT_NEAR(s->sd_s, 21e-9, 3e-9);
  EXPECT_NEAR(s->mean_rate_hz, 1003.05, 0.02);
  EXPECT_GT(s->lattice_statistic, 0.9); // the comb is the counter's, not the sensor's
  EXPECT_GE(s->modes_s.size(), 3u);
  EXPECT_LE(s->modes_s.size(), 4u);
  EXPECT_NEAR(s->temperature_correlation, 0.64, 0.15);
  EXPECT_GT(s->temperature_slope_s_per_degc, 0.0);
  EXPECT_LE(s->over_temperature.size(), 100u);
  EXPECT_GE(s->over_temperature.size(), 40u);
  EXPECT_LE(s->scatter_interval_ns.size(), 4000u);
  EXPECT_GT(s->scatter_interval_ns.size(), 1500u);
  EXPECT_NEAR(s->u_mean_interval_s, std::sqrt(2.0) * 150e-9 / (samples - 1), 1e-18);
}

TEST(SampleClock, ASingleNormalClockHasOneMode) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal(996960.0, 21.0);
  std::vector<std::int64_t> stamps;
  double time_ns = 0.0;
  for (int i = 0; i < 300'000; ++i) {
    time_ns += normal(random);
    stamps.push_back(std::llround(std::floor(time_ns / tick_ns) * tick_ns));
  }
  SampleClockSettings settings;
  settings.tick_s = tick_ns * 1e-9;
  EXPECT_EQ(statistics_of(stamps, settings).modes_s.size(), 1u);
  EXPECT_TRUE(statistics_of(stamps)
                  .modes_s.empty()); // without the tick a mode cannot be told from the comb
}

struct DrawnStamps {
  int samples = 0;
  double jitter_ns = 0.0;
  double stated_s = 0.0; // uncertainty of a stamp
  double tick_ns = 1.0;
};

class MeanInterval : public testing::TestWithParam<DrawnStamps> {};

// 500 draws: chance moves 95.45 % by two and a half standard deviations of 0.9 %.
TEST_P(MeanInterval, IsCoveredByItsExpandedUncertainty) {
  constexpr int draws = 500;
  const DrawnStamps& drawn = GetParam();
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal(0.0, drawn.jitter_ns);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  int covered = 0;
  double squares = 0.0, expanded = 0.0;
  for (int i = 0; i < draws; ++i) {
    const double interval_ns = 1e6 + 1e3 * part(random);
    const double begin_ns = 1e6 * part(random);
    std::vector<std::int64_t> stamps;
    for (int k = 0; k < drawn.samples; ++k) {
      const double at_ns =
          begin_ns + k * interval_ns + (drawn.jitter_ns > 0.0 ? normal(random) : 0.0);
      stamps.push_back(std::llround(std::floor(at_ns / drawn.tick_ns) * drawn.tick_ns));
    }
    const SampleClockStatistics s =
        statistics_of(stamps, {.nominal_rate_hz = 1000.0, .stamp_uncertainty_s = drawn.stated_s});
    const double error_s = s.mean_interval_s - 1e-9 * interval_ns;
    covered += std::abs(error_s) <= s.of_mean_interval().expanded() ? 1 : 0;
    squares += error_s * error_s / draws;
    expanded += s.of_mean_interval().expanded() / draws;
    EXPECT_NEAR(s.rate_deviation_rel(), s.mean_rate_hz / 1000.0 - 1.0, 1e-15);
    EXPECT_NEAR(s.of_rate_deviation().expanded() / s.of_mean_interval().expanded(),
                s.mean_rate_hz / s.mean_interval_s / 1000.0, 1e-6);
  }
  EXPECT_GE(covered, 0.93 * draws);
  EXPECT_LE(covered, 0.98 * draws);
  EXPECT_GT(expanded / (2.0 * std::sqrt(squares)), 0.9);
  EXPECT_LT(expanded / (2.0 * std::sqrt(squares)), 1.3);
}

INSTANTIATE_TEST_SUITE_P(StatedAndFound, MeanInterval,
                         testing::Values(DrawnStamps{200, 500.0, 500e-9}, DrawnStamps{200, 500.0},
                                         DrawnStamps{1000, 5000.0}, DrawnStamps{14, 500.0}));

TEST(SampleClock, FewIntervalsAreKnownWithTheirDegreesOfFreedom) {
  const SampleClockStatistics s = statistics_of(stamps_of({1000, 1010, 990, 1005}));
  EXPECT_DOUBLE_EQ(s.degrees_of_freedom_mean_interval, 2.0);
  EXPECT_NEAR(s.k_mean_interval, 4.526, 1e-3);
  EXPECT_TRUE(std::isnan(s.rate_deviation_rel()));
  const SampleClockStatistics stated =
      statistics_of(stamps_of({1000, 1010, 990, 1005}), {.stamp_uncertainty_s = 1e-9});
  EXPECT_EQ(stated.k_mean_interval, 2.0);
}

} // namespace
} // namespace dyncal::analysis
