#include "analysis/instrument/stamp_deviation.hpp"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double rate = 108'000'324.37;

struct Bench {
  double gps_jitter_s = 0.0;       // white
  double gps_wander_s = 0.0;       // standard deviation of a walk-like wander with 20 s correlation
  double reference_offset_s = 0.0; // after GPS
  double gps_drift = 0.0;          // GPS pulses drift away from true time
  std::size_t seconds = 1000;
  unsigned seed = 1;

  [[nodiscard]] std::vector<PulseEdge> record() const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<PulseEdge> edges;
    double wander_s = gps_wander_s * normal(random);
    const double keep = std::exp(-1.0 / 20.0);
    for (std::size_t s = 0; s < seconds; ++s) {
      const auto time_s = static_cast<double>(s);
      wander_s = keep * wander_s + std::sqrt(1.0 - keep * keep) * gps_wander_s * normal(random);
      const double gps_s = time_s + wander_s + gps_jitter_s * normal(random) + gps_drift * time_s;
      edges.push_back({PulseInput::gps, s, ticks(gps_s)});
      edges.push_back({PulseInput::reference, s, ticks(time_s + reference_offset_s)});
    }
    return edges;
  }
  static std::uint64_t ticks(double time_s) {
    return static_cast<std::uint64_t>(std::llround((time_s + 5.0) * rate)) % (1ULL << 32);
  }
};

StampDeviationStatistics judged(const Bench& bench, const StampDeviationSettings& settings = {}) {
  const auto sorted = sort_pulse_edges(bench.record());
  EXPECT_TRUE(sorted);
  const auto statistics = stamp_deviations(*sorted, settings);
  EXPECT_TRUE(statistics);
  return *statistics;
}

TEST(StampDeviation, APerfectReceiverLeavesTheTicksOfTheCounter) {
  const auto statistics = judged({.reference_offset_s = 0.3}, {.reference_offset_s = 0.3});
  EXPECT_EQ(statistics.untrusted, 2U);
  EXPECT_EQ(statistics.deviations.size(), 998U);
  EXPECT_LT(statistics.maximum_s, 1.0 / rate);
  EXPECT_GT(statistics.minimum_s, -1.0 / rate);
  EXPECT_NEAR(statistics.mean_s, 0.0, 1e-9);
}

TEST(StampDeviation, AKnownOffsetOfTheReferenceGivesTheMeanItsSign) {
  // The reference comes 50 ns later than stated: the stamps are too late by as much.
  const auto statistics = judged({.gps_jitter_s = 20e-9, .reference_offset_s = 0.25 + 50e-9},
                                 {.reference_offset_s = 0.25, .u_reference_s = 5e-9});
  EXPECT_NEAR(statistics.mean_s, 50e-9, 4.0 * statistics.u_mean_s);
  EXPECT_GE(statistics.u_mean_s, 5e-9);
  // A pulse of GPS that comes late by e makes the stamps after it too early by e, at the same time
  // the figures of the rate average it out.
  EXPECT_NEAR(statistics.sd_s, 20e-9, 3.0 * statistics.u_sd_s + 2e-9);
}

TEST(StampDeviation, WithoutAnOffsetTheMeanIsTakenOff) {
  const auto statistics = judged({.gps_jitter_s = 30e-9, .reference_offset_s = 0.40782});
  EXPECT_EQ(statistics.mean_s, 0.0);
  EXPECT_NEAR(statistics.reference_offset_s, 0.40782, 10e-9);
}

TEST(StampDeviation, OffsetsNearHalfASecondAndNegativeOnesAreOneOffset) {
  for (const double offset_s : {0.4999999, 0.5000001, -0.2, 0.999999}) {
    const auto statistics = judged({.gps_jitter_s = 100e-9, .reference_offset_s = offset_s});
    EXPECT_LT(statistics.maximum_s - statistics.minimum_s, 2e-6) << offset_s;
  }
  const auto given = judged({.reference_offset_s = 0.999999}, {.reference_offset_s = -1e-6});
  EXPECT_NEAR(given.mean_s, 0.0, 1e-9);
}

TEST(StampDeviation, UncertaintyOfTheMeanKnowsThatTheReceiverWanders) {
  int inside = 0;
  const int rounds = 200;
  double independent = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const auto statistics = judged(
        {.gps_wander_s = 100e-9, .seconds = 4000, .seed = 100U + static_cast<unsigned>(round)},
        {.reference_offset_s = 0.0});
    inside += std::abs(statistics.mean_s) <= 2.0 * statistics.u_mean_s ? 1 : 0;
    independent += statistics.effective_count / rounds;
  }
  EXPECT_GE(inside, rounds * 88 / 100);
  EXPECT_GT(independent, 30.0); // 4000 s with 20 s of correlation: 100 values
  EXPECT_LT(independent, 150.0);
}

TEST(StampDeviation, ADriftOfTheReceiverIsFound) {
  // GPS pulses later and later: the unit's seconds come late, its stamps are too early.
  const auto statistics = judged({.gps_jitter_s = 20e-9, .gps_drift = 1e-10, .seconds = 3000});
  EXPECT_NEAR(statistics.drift, -1e-10, 4.0 * statistics.u_drift);
  EXPECT_LT(statistics.u_drift, 5e-12);
}

TEST(StampDeviation, AllanDeviationOfWhitePhaseNoiseFallsWithTheTime) {
  const auto statistics =
      judged({.gps_jitter_s = 50e-9, .reference_offset_s = 0.4, .seconds = 4000});
  ASSERT_GE(statistics.allan.size(), 9U);
  EXPECT_NEAR(statistics.allan[0].deviation, std::sqrt(3.0) * 50e-9, 0.1 * std::sqrt(3.0) * 50e-9);
  EXPECT_NEAR(statistics.allan[5].deviation * 32.0, statistics.allan[0].deviation,
              0.15 * statistics.allan[0].deviation);
}

TEST(StampDeviation, AnExtraEdgeOfTheReceiverLeavesTheStampsAlone) {
  std::vector<PulseEdge> record = Bench{.reference_offset_s = 0.4}.record();
  PulseEdge extra = record[400];
  extra.ticks = (extra.ticks + 20'000'000) % (1ULL << 32);
  record.insert(record.begin() + 401, extra);
  const auto sorted = sort_pulse_edges(record);
  ASSERT_TRUE(sorted);
  const auto statistics = stamp_deviations(*sorted);
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->deviations.size(), 998U);
  EXPECT_LT(statistics->maximum_s - statistics->minimum_s, 2.0 / rate);
}

TEST(StampDeviation, GpsPulsesAloneAreForetoldFromThoseBefore) {
  std::vector<PulseEdge> record = Bench{.gps_jitter_s = 40e-9, .seconds = 3000}.record();
  std::erase_if(record, [](const PulseEdge& edge) { return edge.input == PulseInput::reference; });
  const auto sorted = sort_pulse_edges(record);
  ASSERT_TRUE(sorted);
  const auto prediction = predict_gps_pulses(*sorted);
  ASSERT_TRUE(prediction);
  EXPECT_NEAR(prediction->sd_s, std::sqrt(2.0) * 40e-9, 4e-9);
  EXPECT_NEAR(prediction->ticks_per_second, rate, 2.0);
  EXPECT_FALSE(stamp_deviations(*sorted));
}

} // namespace
} // namespace dyncal::analysis
