#include "analysis/sine/drift_order.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/disturbances.hpp"

namespace dyncal::analysis {
namespace {

// 0.4 Hz, three periods at 1 kS/s.
struct SlowStep {
  double drift = 0.0; // over half the record, of the amplitude
  int shape = 1;      // 1: linear, 2: quadratic, 3: an exponential that settles
  double noise = 1e-2;
  double frequency_hz = 0.4;
  double periods = 3.0;
};

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  double phase_rad = 0.0; // in the middle
};

Record record_of(const SlowStep& step, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, step.noise);
  Record record;
  record.phase_rad = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
  const auto n = static_cast<std::int64_t>(1000.0 * step.periods / step.frequency_hz);
  for (std::int64_t i = 0; i <= n; ++i) {
    const double u = 2.0 * static_cast<double>(i) / static_cast<double>(n) - 1.0;
    const double drift = step.shape == 1   ? u
                         : step.shape == 2 ? u * u
                                           : 2.0 * std::exp(-1.5 * (u + 1.0));
    const double t = 1e-3 * (static_cast<double>(i) - 0.5 * static_cast<double>(n));
    record.stamps_ns.push_back(1'000'000 * i);
    record.values.push_back(
        std::sin(2.0 * std::numbers::pi * step.frequency_hz * t + record.phase_rad) +
        step.drift * drift + noise(random));
  }
  return record;
}

CleanedFit fit_of(const SlowStep& step, const Record& record) {
  const std::span<const double> channels[] = {record.values};
  const auto fit = fit_sine_beside_disturbances(
      Frequency::from_hz(step.frequency_hz),
      (record.stamps_ns.back() - record.stamps_ns.front()) / 2, record.stamps_ns, channels);
  EXPECT_TRUE(fit);
  return fit ? fit->front() : CleanedFit{};
}

int runs() {
  const char* text = std::getenv("DYNCAL_COVERAGE_RUNS");
  return text ? std::stoi(text) : 300;
}

struct Coverage {
  double magnitude = 0.0, phase = 0.0;
};

Coverage coverage_of(const SlowStep& step) {
  Coverage covered;
  for (int run = 0; run < runs(); ++run) {
    const Record record = record_of(step, static_cast<unsigned>(run) + 1);
    const SineFit fit = fit_of(step, record).fit;
    covered.magnitude += std::abs(fit.amplitude() - 1.0) <= 2.0 * fit.u_amplitude();
    covered.phase += std::abs(std::remainder(fit.phase_rad() - record.phase_rad,
                                             2.0 * std::numbers::pi)) <= 2.0 * fit.u_phase_rad();
  }
  return {covered.magnitude / runs(), covered.phase / runs()};
}

double slack() {
  return 3.0 * std::sqrt(0.0455 * 0.9545 / runs());
}

TEST(DriftOrder, DriftOfASlowStepIsCovered) {
  for (const int shape : {1, 2}) {
    const Coverage covered = coverage_of({.drift = 0.02, .shape = shape});
    EXPECT_NEAR(covered.magnitude, 0.9545, slack()) << shape;
    EXPECT_NEAR(covered.phase, 0.9545, slack()) << shape;
  }
  // No polynomial is an exponential, but the rest of it is small.
  const Coverage settling = coverage_of({.drift = 0.02, .shape = 3});
  EXPECT_GT(settling.magnitude, 0.93 - slack());
  EXPECT_GT(settling.phase, 0.93 - slack());
}

// Drift of 1..5 standard uncertainties: sometimes seen, sometimes not.
TEST(DriftOrder, DriftThatHardlyShowsIsInTheUncertainty) {
  const double u_drift = 1e-2 * std::sqrt(3.0 / 7501.0);
  for (const double size : {1.0, 2.0, 3.0, 4.0, 5.0}) {
    const Coverage covered = coverage_of({.drift = size * u_drift});
    EXPECT_GT(covered.magnitude, 0.92 - slack()) << size;
    EXPECT_GT(covered.phase, 0.92 - slack()) << size;
  }
}

TEST(DriftOrder, CleanRecordsKeepTheirResult) {
  int moved = 0;
  int widened = 0;
  for (const double periods : {3.0, 40.0}) {
    const SlowStep step{.frequency_hz = periods > 10.0 ? 8.0 : 0.4, .periods = periods};
    for (int run = 0; run < runs(); ++run) {
      const Record record = record_of(step, static_cast<unsigned>(run) + 5000);
      const std::span<const double> channels[] = {record.values};
      const auto plain = fit_sine(Frequency::from_hz(step.frequency_hz),
                                  (record.stamps_ns.back() - record.stamps_ns.front()) / 2,
                                  record.stamps_ns, channels);
      ASSERT_TRUE(plain);
      const CleanedFit fit = fit_of(step, record);
      const double u = plain->front().u_amplitude();
      moved += std::abs(fit.fit.sine - plain->front().sine) > 0.1 * u ||
               std::abs(fit.fit.cosine - plain->front().cosine) > 0.1 * u;
      widened += fit.fit.u_amplitude() > 1.1 * u || fit.fit.u_phase_rad() > 1.1 * u;
    }
  }
  EXPECT_LE(moved, 0.01 * 2 * runs());
  EXPECT_LE(widened, 0.02 * 2 * runs());
}

TEST(DriftOrder, TheFrequencyDoesNotFollowTheDrift) {
  SlowStep step{.drift = 0.05};
  const Record record = record_of(step, 3);
  const std::span<const double> channels[] = {record.values};
  const auto fit = fit_frequency_beside_disturbances(Frequency::from_hz(0.4005), 0.01,
                                                     3'750'000'000, record.stamps_ns, channels);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->frequency.hz(), 0.4, 4.0 * fit->u_frequency_hz);
}

TEST(DriftOrder, WhatIsRemovedIsThePolynomial) {
  const std::vector<std::int64_t> stamps{0, 10, 20};
  std::vector<double> values{1.0, 5.0, 3.0};
  const double powers[] = {1.0, 2.0}; // u + 2 u^2
  remove_drift(powers, stamps, values);
  EXPECT_EQ(values, (std::vector<double>{0.0, 5.0, 0.0}));
}

} // namespace
} // namespace dyncal::analysis
