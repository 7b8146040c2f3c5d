#include "analysis/method/clock_link.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"
#include "analysis/method/sample_stamping.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double magnitude = 0.95;
constexpr double delay_s = 1.3e-3;
constexpr double adc_lag_s = 4.6e-7;

// Two instruments in UTC that record one step, and how wrong their links are.
struct Bench {
  double frequency_hz = 80.0;
  double u_lag_s = 1e-7; // of the ADC's delay
  double u_stamps_s = 1e-7;
  double lag_error_s = 0.0;
  double stamps_error_s = 0.0; // of the sensor's clock: it is late
};

struct Records {
  std::vector<std::int64_t> acs_ns, dau_ns;
  std::vector<double> reference, sync_acs, sensor, sync_dau;
};

Records record(const Bench& bench, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> anywhere(0.0, 0.1);
  const double w = 2.0 * pi * bench.frequency_hz;
  constexpr std::int64_t epoch_ns = 1'760'000'000'000'000'000;
  Records records;
  const double acs_begin_s = anywhere(random);
  for (int i = 0; i < 5000; ++i) {
    const double t = acs_begin_s + i / 5000.0;
    records.acs_ns.push_back(epoch_ns + std::llround(t * 1e9));
    records.reference.push_back(10.0 * std::sin(w * t - 0.4) + 2e-4 * normal(random));
    records.sync_acs.push_back(std::sin(w * t + 0.3) + 1e-5 * normal(random));
  }
  const double dau_begin_s = anywhere(random);
  for (int i = 0; i < 1003; ++i) {
    const double t = dau_begin_s + i / 1003.0;
    const double delayed = t - adc_lag_s - bench.lag_error_s;
    records.dau_ns.push_back(epoch_ns + std::llround((t + bench.stamps_error_s) * 1e9));
    records.sensor.push_back(10.0 * magnitude * std::sin(w * (t - delay_s) - 0.4) +
                             2e-4 * normal(random));
    records.sync_dau.push_back(0.17 * std::sin(w * delayed + 0.3) + 1e-6 * normal(random));
  }
  return records;
}

SampleStampingResult evaluate(const Bench& bench, const Records& records,
                              std::optional<double> u_utc_s) {
  const double w = 2.0 * pi * bench.frequency_hz;
  SampleStampingInput input{.frequency = Frequency::from_hz(bench.frequency_hz)};
  input.frequency_search_rel = 0.0;
  input.acs_stamps_ns = records.acs_ns;
  input.reference = {"acs/reference", records.reference};
  input.sync_acs = {"acs/sync", records.sync_acs};
  input.dau_stamps_ns = records.dau_ns;
  input.sync_dau = {"dau/sync", records.sync_dau};
  input.dut = {{"dau/z", records.sensor}};
  input.adc = {0.17, w * adc_lag_s, 0.0, w * bench.u_lag_s};
  input.u_utc_s = u_utc_s;
  auto result = evaluate_sample_stamping(input);
  EXPECT_TRUE(result.has_value());
  return *result;
}

double error_rad(const Bench& bench, const TransferPoint& point) {
  return wrap_phase(point.phase_rad + 2.0 * pi * bench.frequency_hz * delay_s);
}

// Both links drawn within what is stated of them.
Bench drawn(double u_lag_s, double u_stamps_s, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(1.0, 2.6);
  return {.frequency_hz = std::pow(10.0, exponent(random)),
          .u_lag_s = u_lag_s,
          .u_stamps_s = u_stamps_s,
          .lag_error_s = u_lag_s * normal(random),
          .stamps_error_s = u_stamps_s * normal(random)};
}

TEST(ClockLink, BothLinksCountByTheirUncertainty) {
  for (const auto& [u_lag_s, u_stamps_s] :
       {std::pair(1e-7, 1e-7), std::pair(3e-7, 1e-7), std::pair(5e-8, 4e-7)}) {
    std::mt19937_64 random(7);
    constexpr int draws = 150;
    int covered = 0;
    for (int draw = 0; draw < draws; ++draw) {
      const Bench bench = drawn(u_lag_s, u_stamps_s, random);
      const Records records = record(bench, random());
      const auto both = evaluate(bench, records, u_stamps_s);
      const TransferPoint& point = both.points.front();
      covered += std::abs(error_rad(bench, point)) <= 2.0 * point.u_phase_rad ? 1 : 0;
      if (std::abs(both.findings.clock_link->offset_s) <
          2.0 * both.findings.clock_link->u_offset_s()) {
        EXPECT_LE(point.u_phase_rad,
                  evaluate(bench, records, {}).points.front().u_phase_rad * (1.0 + 1e-9));
      }
    }
    EXPECT_GE(covered, draws * 91 / 100) << u_lag_s;
    EXPECT_LT(covered, draws) << u_lag_s;
  }
}

TEST(ClockLink, TellsByHowMuchTheSensorsClockIsLate) {
  for (const double late_s : {-2e-4, 0.0, 3e-6}) {
    const Bench bench{.stamps_error_s = late_s};
    const auto result = evaluate(bench, record(bench, 3), 1e-7);
    EXPECT_NEAR(result.findings.clock_link->offset_s, late_s, 3e-8);
  }
}

TEST(ClockLink, LinksThatContradictAreBothHeld) {
  for (const bool of_sync : {true, false}) {
    Bench bench;
    (of_sync ? bench.lag_error_s : bench.stamps_error_s) = 2e-6;
    const auto result = evaluate(bench, record(bench, 4), bench.u_stamps_s);
    const TransferPoint& point = result.points.front();
    EXPECT_LE(std::abs(error_rad(bench, point)), 2.2 * point.u_phase_rad) << of_sync;
    EXPECT_GT(std::abs(result.findings.clock_link->offset_s),
              4.0 * result.findings.clock_link->u_offset_s());
  }
}

// 1 us in either link, where that is 8 u of their difference, is beyond 4 u of it in every draw;
// without an error none is.
TEST(ClockLink, AnErrorOfEightUncertaintiesStandsOut) {
  std::mt19937_64 random(11);
  for (int draw = 0; draw < 60; ++draw) {
    for (const double error_s : {0.0, 1e-6, -1e-6}) {
      Bench bench = drawn(8e-8, 8e-8, random);
      (draw % 2 == 0 ? bench.lag_error_s : bench.stamps_error_s) += error_s;
      const auto link =
          evaluate(bench, record(bench, random()), bench.u_stamps_s).findings.clock_link;
      EXPECT_EQ(std::abs(link->offset_s) > 4.0 * link->u_offset_s(), error_s != 0.0)
          << bench.frequency_hz;
    }
  }
}

TEST(ClockLink, WithoutUtcSyncAloneLinks) {
  const Bench bench{.lag_error_s = 1e-6};
  const auto result = evaluate(bench, record(bench, 5), std::nullopt);
  EXPECT_FALSE(result.findings.clock_link);
  for (const Contribution& row : result.points.front().budget) {
    EXPECT_NE(row.kind, ContributionKind::clock_offset);
  }
}

} // namespace
} // namespace dyncal::analysis
