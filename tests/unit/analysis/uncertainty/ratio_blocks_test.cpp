#include "analysis/uncertainty/ratio_blocks.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double frequency_hz = 80.0;
using Envelope = std::function<double(double)>;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  SineFit fit;
};

// Three seconds from `begin_s` on; `level` and `lag_rad` over time.
Record record_of(
    double begin_s, double noise, unsigned seed, const Envelope& level,
    const Envelope& lag_rad = [](double) { return 0.0; }) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  Record record;
  for (int i = 0; i < 3000; ++i) {
    const double t = begin_s + i * 1e-3;
    record.stamps_ns.push_back(1'000'000LL * i);
    record.values.push_back(level(t) * std::sin(2.0 * pi * frequency_hz * t - lag_rad(t)) +
                            normal(random));
  }
  const std::span<const double> channel[] = {record.values};
  record.fit = fit_sine(*Frequency::parse("80"), 0, record.stamps_ns, channel)->front();
  return record;
}

BlockSeries series_of(const Record& record) {
  const FittedValues values[] = {{record.values, record.fit}};
  const auto blocks = phasors_in_blocks(*Frequency::parse("80"), 0, record.stamps_ns, values);
  return *block_series(blocks.front(), record.fit);
}

double steady(double) {
  return 1.0;
}

TEST(RatioBlocks, OfWhiteNoiseKeepTheValueAndAddNothing) {
  int changes = 0, added = 0;
  constexpr int draws = 50;
  for (unsigned seed = 1; seed <= draws; ++seed) {
    const auto ratio = compare_in_blocks(series_of(record_of(0.0, 0.01, seed, steady)),
                                         series_of(record_of(0.0, 0.01, seed + 1000, steady)), {});
    ASSERT_TRUE(ratio.has_value());
    EXPECT_EQ(ratio->correction, std::complex<double>());
    changes += ratio->change ? 1 : 0;
    added += ratio->u_magnitude_rel > 1.3 * 0.01 * std::sqrt(2.0 * 2.0 / 3000.0) ? 1 : 0;
  }
  EXPECT_EQ(changes, 0);
  EXPECT_LE(added, 1);
}

TEST(RatioBlocks, WhatBothShareCancels) {
  const Envelope swings = [](double t) { return 1.0 + 0.02 * std::sin(2.0 * pi * 1.1 * t + 0.4); };
  const auto ratio = compare_in_blocks(series_of(record_of(0.0, 1e-3, 1, swings)),
                                       series_of(record_of(0.0, 1e-3, 2, swings)), {});
  ASSERT_TRUE(ratio.has_value());
  EXPECT_LT(ratio->u_magnitude_rel, 1e-4);
  EXPECT_LT(std::abs(ratio->correction), 1e-4);
  EXPECT_FALSE(ratio->change.has_value());
}

// The numerator begins 37 ms later; sync says so modulo 12.5 ms.
TEST(RatioBlocks, FindTheOffsetOfTwoClocksInWhatBothShare) {
  const Envelope swings = [](double t) { return 1.0 + 0.02 * std::sin(2.0 * pi * 2.3 * t + 0.4); };
  const Record late = record_of(0.037, 1e-3, 1, swings), early = record_of(0.0, 1e-3, 2, swings);
  const auto ratio =
      compare_in_blocks(series_of(late), series_of(early),
                        {.offset_s = 0.037 - 3 * 0.0125, .period_s = 0.0125, .reach_s = 0.1});
  ASSERT_TRUE(ratio.has_value());
  EXPECT_LT(ratio->u_magnitude_rel, 2e-4);
  const double of_records = std::log(late.fit.amplitude() / early.fit.amplitude());
  EXPECT_NEAR(of_records + ratio->correction.real(), 0.0, 2e-4);
}

// A ramp says nothing of the offset, which is then in u.
TEST(RatioBlocks, ARampLeavesTheOffsetInTheUncertainty) {
  const Envelope ramp = [](double t) { return 1.0 + 0.05 * t / 3.0; };
  const auto ratio = compare_in_blocks(series_of(record_of(0.05, 1e-4, 1, ramp)),
                                       series_of(record_of(0.0, 1e-4, 2, ramp)),
                                       {.offset_s = 0.0, .period_s = 0.0125, .reach_s = 0.1});
  ASSERT_TRUE(ratio.has_value());
  EXPECT_GT(ratio->u_correction_magnitude_rel, 0.05 / 3.0 * 0.03);
  EXPECT_LT(ratio->u_correction_magnitude_rel, 0.05 / 3.0 * 0.06);
  EXPECT_FALSE(ratio->change.has_value());
}

// How both began tells it, to what it is known; but not what lies where no record can begin, nor
// what is hardly known.
TEST(RatioBlocks, OnsetsTellTheOffsetOfARamp) {
  const Envelope ramp = [](double t) { return 1.0 + 0.05 * t / 3.0; };
  const Record late = record_of(0.05, 1e-4, 1, ramp), early = record_of(0.0, 1e-4, 2, ramp);
  const double of_records = std::log(late.fit.amplitude() / early.fit.amplitude());
  const auto with = [&](const SeenOffset& seen) {
    return *compare_in_blocks(series_of(late), series_of(early),
                              {.offset_s = 0.0, .period_s = 0.0125, .reach_s = 0.1, .seen = seen});
  };
  for (const double error_s : {-2e-3, 0.0, 2e-3}) {
    const auto ratio = with({0.05 + error_s, 2e-3});
    EXPECT_NEAR(of_records + ratio.correction.real(), 0.0,
                2.0 * ratio.u_correction_magnitude_rel + 1e-5);
    EXPECT_NEAR(ratio.u_correction_magnitude_rel, 0.05 / 3.0 * 2e-3, 0.05 / 3.0 * 5e-4);
  }
  for (const SeenOffset& seen : {SeenOffset{0.5, 2e-3}, {-0.5, 2e-3}, {0.05, 0.05}}) {
    EXPECT_GT(with(seen).u_correction_magnitude_rel, 0.05 / 3.0 * 0.03);
  }
}

struct Change {
  double gain_rel;
  double lag_rad;
};

class ChangeWithinTheStep : public testing::TestWithParam<Change> {};

TEST_P(ChangeWithinTheStep, IsFoundWithItsPlaceAndSize) {
  const auto [gain_rel, lag_rad] = GetParam();
  const Envelope level = [gain = gain_rel](double t) { return t > 1.3 ? 1.0 + gain : 1.0; };
  const Envelope lag = [lag = lag_rad](double t) { return t > 1.3 ? lag : 0.0; };
  const auto ratio = compare_in_blocks(series_of(record_of(0.0, 2e-3, 1, level, lag)),
                                       series_of(record_of(0.0, 2e-3, 2, steady)), {});
  ASSERT_TRUE(ratio && ratio->change);
  EXPECT_NEAR(ratio->change->at_s, 1.3, 0.06);
  // One block of 58 holds the change itself.
  const double margin = 1e-3 + 0.01 * (std::abs(gain_rel) + std::abs(lag_rad));
  EXPECT_NEAR(ratio->change->magnitude_rel, std::log1p(gain_rel), margin);
  EXPECT_NEAR(ratio->change->phase_rad, -lag_rad, margin);
  // It is in u: half the change, as if the record said nothing of when.
  EXPECT_GT(ratio->u_magnitude_rel + ratio->u_phase_rad,
            0.1 * (std::abs(gain_rel) + std::abs(lag_rad)));
}

INSTANTIATE_TEST_SUITE_P(RatioBlocks, ChangeWithinTheStep,
                         testing::Values(Change{0.02, 0.0}, Change{-0.3, 0.0}, Change{0.0, 0.05},
                                         Change{0.0, 1.5}, Change{0.01, -0.02}));

// A change of `sizes` standard deviations of the mean, `at_s` of 3 s, drawn `draws` times: how
// often it is a change, how often either that or the first level lies within U, or both levels do;
// and by how much U is larger than of noise alone, at most.
struct SmallChange {
  int found = 0, found_or_held = 0, found_or_first_held = 0;
  double largest_u = 1.0;
};

SmallChange small_change_of(double sizes, int draws, double at_s = 1.3) {
  constexpr double noise = 2e-3, u_mean = noise * std::numbers::sqrt2 / 38.7; // sqrt(3000 / 2)
  const double lag_rad = sizes * u_mean;
  SmallChange result;
  for (int seed = 1; seed <= draws; ++seed) {
    const Envelope lag = [=](double t) { return t > at_s ? lag_rad : 0.0; };
    const Record a = record_of(0.0, noise, static_cast<unsigned>(seed), steady, lag);
    const Record b = record_of(0.0, noise, static_cast<unsigned>(seed + draws), steady);
    const auto ratio = compare_in_blocks(series_of(a), series_of(b), {});
    const double phase =
        std::atan2(a.fit.cosine, a.fit.sine) - std::atan2(b.fit.cosine, b.fit.sine);
    const double expanded = 2.0 * std::max(u_mean, ratio->u_phase_rad);
    const bool first_held = std::abs(phase) <= expanded;
    const bool held = first_held && std::abs(phase + lag_rad) <= expanded;
    result.found += ratio->change ? 1 : 0;
    result.found_or_held += ratio->change || held ? 1 : 0;
    result.found_or_first_held += ratio->change || first_held ? 1 : 0;
    result.largest_u = std::max(result.largest_u, ratio->u_phase_rad / u_mean);
  }
  return result;
}

// Less than the scatter of 58 blocks shows, which it is only a part of.
TEST(RatioBlocks, AChangeOfFewStandardDeviationsIsFoundOrHeld) {
  EXPECT_GE(small_change_of(14.0, 100).found, 99);
  EXPECT_GE(small_change_of(11.0, 100).found_or_held, 90);
  EXPECT_EQ(small_change_of(0.0, 100).found, 0);
}

TEST(RatioBlocks, OfAShortLevelTheLongerOneIsHeld) {
  EXPECT_GE(small_change_of(16.0, 100, 2.7).found_or_first_held, 85);
  EXPECT_GE(small_change_of(30.0, 20, 2.7).found, 20);
}

// One clean step of a hundred is doubted; its u stays of the size that noise has.
TEST(RatioBlocks, ChanceDoesNotMakeUManyTimesLarger) {
  const SmallChange nothing = small_change_of(0.0, 1500);
  EXPECT_EQ(nothing.found, 0);
  EXPECT_GT(nothing.largest_u, 1.5);
  EXPECT_LT(nothing.largest_u, 5.0);
}

// Blocks of different phase add to a shorter phasor; their mean is not shorter.
TEST(RatioBlocks, AWanderingPhaseShortensTheRecordAndNotTheBlocks) {
  const Envelope wanders = [](double t) { return 0.5 * std::sin(2.0 * pi * 0.7 * t); };
  const Record turned = record_of(0.0, 1e-4, 1, steady, wanders);
  EXPECT_LT(turned.fit.amplitude(), 0.95);
  const auto ratio =
      compare_in_blocks(series_of(turned), series_of(record_of(0.0, 1e-4, 2, steady)), {});
  ASSERT_TRUE(ratio.has_value());
  EXPECT_NEAR(std::log(turned.fit.amplitude()) + ratio->correction.real(), 0.0, 1e-3);
}

TEST(RatioBlocks, TooFewPeriodsOrNoSignalSayNothing) {
  const Record record = record_of(0.0, 0.01, 1, steady);
  const auto blocks_of_first = [&](std::size_t n) {
    const FittedValues values[] = {{std::span<const double>(record.values).first(n), record.fit}};
    return phasors_in_blocks(*Frequency::parse("80"), 0, std::span(record.stamps_ns).first(n),
                             values);
  };
  EXPECT_TRUE(blocks_of_first(40).front().empty()); // 3.2 periods
  EXPECT_FALSE(blocks_of_first(3000).front().empty());
  Record noise = record_of(0.0, 1.0, 3, [](double) { return 0.15; });
  const FittedValues values[] = {{noise.values, noise.fit}};
  const auto blocks = phasors_in_blocks(*Frequency::parse("80"), 0, noise.stamps_ns, values);
  EXPECT_FALSE(block_series(blocks.front(), noise.fit).has_value());
}

} // namespace
} // namespace dyncal::analysis
