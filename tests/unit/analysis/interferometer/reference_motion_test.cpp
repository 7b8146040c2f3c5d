#include "analysis/interferometer/reference_motion.hpp"

#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/analysis/interferometer/simulated_interferometer.hpp"
#include "tests/unit/analysis/interferometer/whole_chain.hpp"

namespace dyncal::analysis {
namespace {

using simulated::chain;
using simulated::ChainResult;
using simulated::Detectors;
using simulated::Motion;
using simulated::simulate;
using simulated::true_acceleration;

simulated::ChainSettings settings_of(const Motion& motion) {
  return {motion.frequency_hz, motion.sample_rate_hz,
          displacement_per_turn_m(simulated::wavelength_m, 1)};
}

std::optional<ChainResult> run(const Motion& motion, std::uint64_t seed) {
  const Detectors detectors;
  const auto signals = simulate(motion, detectors, seed);
  return chain(settings_of(motion), detectors.ellipse, signals.u1, signals.u2, signals.sync);
}

// Errors over their standard uncertainties in `draws` seeds, where the ellipse is known.
struct Draws {
  double rms_magnitude = 0.0;
  double rms_phase = 0.0;
  int covered = 0; // both within two standard uncertainties
  int figures = 0;
};

Draws draw(const Motion& motion, int draws) {
  Draws result;
  for (int i = 0; i < draws; ++i) {
    const auto one = run(motion, static_cast<std::uint64_t>(i + 1));
    if (!one) {
      return {};
    }
    const std::complex<double> ratio = one->acceleration / true_acceleration(motion);
    const double magnitude = (std::abs(ratio) - 1.0) / one->u_magnitude_rel;
    const double phase = std::arg(ratio) / one->u_phase_rad;
    result.rms_magnitude += magnitude * magnitude / draws;
    result.rms_phase += phase * phase / draws;
    result.covered += std::abs(magnitude) < 2.0 ? 1 : 0;
    result.covered += std::abs(phase) < 2.0 ? 1 : 0;
    result.figures += 2;
  }
  result.rms_magnitude = std::sqrt(result.rms_magnitude);
  result.rms_phase = std::sqrt(result.rms_phase);
  return result;
}

void expect_honest(const Motion& motion, int draws) {
  const Draws result = draw(motion, draws);
  ASSERT_EQ(result.figures, 2 * draws);
  for (const double rms : {result.rms_magnitude, result.rms_phase}) {
    EXPECT_GT(rms, 0.7);
    EXPECT_LT(rms, 1.4);
  }
  // 95.45 %, less 3.1 binomial standard deviations (once in a thousand).
  const double expected = 0.9545 * result.figures;
  EXPECT_GT(result.covered, expected - 3.1 * std::sqrt(expected * 0.0455));
}

TEST(ReferenceMotion, ItsUncertaintyHoldsForNoiseOfTheDetectors) {
  expect_honest({1000.0, 100.0, 0.4, 1e5, 0.05, 1e-7, 0.0, 0.05}, 100);
}

TEST(ReferenceMotion, ItsUncertaintyHoldsForSmallFastMotion) {
  expect_honest({5000.0, 10.0, 0.4, 5e5, 0.01, 1e-7, 0.0, 0.05}, 100);
}

TEST(ReferenceMotion, ItsUncertaintyHoldsBesideTheMotionOfTheTable) {
  expect_honest({80.0, 1.0, 0.4, 2e4, 0.5, 1e-7, 0.5, 0.05}, 200);
}

// DYNCAL_COVERAGE_RUNS: how many draws of each row, 30 at least for what is held of many.
int coverage_runs() {
  const char* text = std::getenv("DYNCAL_COVERAGE_RUNS");
  return text != nullptr ? std::atoi(text) : 1;
}

// From 10 Hz to 2 kHz and 0.1 to 100 m/s^2, at 1 MS/s; 1e-7 m/s of drift.
TEST(ReferenceMotion, ItsUncertaintyHoldsFromSlowToFastAndFromSmallToLarge) {
  constexpr int fewest = 30;
  const int runs = coverage_runs();
  const struct {
    double frequency_hz;
    double acceleration_m_s2;
    double seconds;
  } rows[] = {{10.0, 0.1, 1.0},    {80.0, 1.0, 1.0},      {160.0, 10.0, 1.0},
              {1000.0, 0.1, 1.0},  {1000.0, 100.0, 0.5},  {2000.0, 10.0, 1.0},
              {5000.0, 50.0, 0.2}, {10000.0, 200.0, 0.1}, {10000.0, 10.0, 0.1}};
  for (const auto& row : rows) {
    const Motion motion{
        row.frequency_hz, row.acceleration_m_s2, 0.4, 1e6, row.seconds, 1e-7, 0.0, 0.05};
    SCOPED_TRACE(std::to_string(row.frequency_hz) + " Hz");
    if (runs >= fewest) {
      expect_honest(motion, runs);
      continue;
    }
    const auto one = run(motion, 1);
    ASSERT_TRUE(one);
    const std::complex<double> ratio = one->acceleration / true_acceleration(motion);
    EXPECT_LT(std::abs(std::abs(ratio) - 1.0), 4.0 * one->u_magnitude_rel);
    EXPECT_LT(std::abs(std::arg(ratio)), 4.0 * one->u_phase_rad);
  }
}

TEST(ReferenceMotion, SlowMotionOfTheTableIsNoExcitation) {
  // 1.2 um within the record, 400 times the excitation's displacement.
  Motion motion{1000.0, 0.1, 0.4, 1e5, 1.0, 1e-6, 1.0, 0.05};
  const auto result = run(motion, 1);
  ASSERT_TRUE(result);
  const std::complex<double> ratio = result->acceleration / true_acceleration(motion);
  EXPECT_LT(std::abs(ratio - 1.0), 4.0 * std::hypot(result->u_magnitude_rel, result->u_phase_rad));
  EXPECT_LT(std::abs(ratio - 1.0), 0.05);
}

TEST(ReferenceMotion, TheDirectionTurnsTheAcceleration) {
  const Motion motion;
  const Detectors detectors;
  const auto signals = simulate(motion, detectors, 3);
  simulated::ChainSettings settings = settings_of(motion);
  settings.displacement_per_turn_m = -settings.displacement_per_turn_m;
  const auto turned = chain(settings, detectors.ellipse, signals.u1, signals.u2, signals.sync);
  ASSERT_TRUE(turned);
  EXPECT_LT(std::abs(turned->acceleration / true_acceleration(motion) + 1.0), 1e-5);
}

// A sine beside a straight line, of as many samples.
struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

Record record_of(double rate_hz, std::size_t samples, double frequency_hz) {
  Record record;
  for (std::size_t i = 0; i < samples; ++i) {
    record.stamps_ns.push_back(std::llround(static_cast<double>(i) * 1e9 / rate_hz));
    const double t = static_cast<double>(record.stamps_ns.back()) * 1e-9;
    record.values.push_back(3.0 * std::sin(2.0 * std::numbers::pi * frequency_hz * t + 0.3) +
                            20.0 * t);
  }
  return record;
}

Expected<StepMotion> motion_of(const Record& record, double frequency_hz,
                               MotionQuantity quantity = MotionQuantity::displacement) {
  return motion_of_step(quantity, Frequency::from_hz(frequency_hz), record.stamps_ns,
                        record.values);
}

std::complex<double> phasor_in(const StepMotion& motion, double frequency_hz) {
  const std::span<const double> values[] = {motion.values};
  const auto fit = fit_sine(Frequency::from_hz(frequency_hz), 0, motion.stamps_ns, values);
  EXPECT_TRUE(fit);
  return fit ? simulated::phasor_of(fit->front()) : 0.0;
}

TEST(ReferenceMotion, DecimatesToFourToEightTimesTheFrequency) {
  for (double rate_hz = 640.0; rate_hz < 4e5; rate_hz *= 1.07) {
    const auto motion = motion_of(record_of(rate_hz, 20000, 160.0), 160.0);
    ASSERT_TRUE(motion) << motion.error().message;
    EXPECT_GE(motion->rate_hz, 640.0 * (1.0 - 1e-6)) << rate_hz;
    EXPECT_LE(motion->rate_hz, 1280.0 * (1.0 + 1e-6)) << rate_hz;
    EXPECT_LT(std::abs(phasor_in(*motion, 160.0) - std::polar(3.0, 0.3)), 1e-5) << rate_hz;
  }
}

TEST(ReferenceMotion, GapsAndSamplesThatAreMissingChangeNothing) {
  Record record = record_of(5000.0, 20000, 40.0);
  for (const std::size_t at : {15000, 9000, 8990, 100}) {
    record.stamps_ns.erase(record.stamps_ns.begin() + static_cast<std::ptrdiff_t>(at));
    record.values.erase(record.values.begin() + static_cast<std::ptrdiff_t>(at));
  }
  const auto motion = motion_of(record, 40.0);
  ASSERT_TRUE(motion);
  EXPECT_GT(motion->values.size(), 600u);
  EXPECT_LT(std::abs(phasor_in(*motion, 40.0) - std::polar(3.0, 0.3)), 1e-6);
}

TEST(ReferenceMotion, StampsNeedNotBeEven) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::int64_t> jitter_ns(-20000, 20000);
  Record record = record_of(5000.0, 20000, 40.0);
  for (std::size_t i = 0; i < record.values.size(); ++i) {
    record.stamps_ns[i] += jitter_ns(random);
    const double t = static_cast<double>(record.stamps_ns[i]) * 1e-9;
    record.values[i] = 3.0 * std::sin(2.0 * std::numbers::pi * 40.0 * t + 0.3);
  }
  const auto motion = motion_of(record, 40.0);
  ASSERT_TRUE(motion);
  const std::complex<double> phasor = phasor_in(*motion, 40.0);
  // A white jitter of 11.5 us turns 2.9 mrad a sample, and every value is of about thirty.
  EXPECT_LT(std::abs(phasor - std::polar(3.0, 0.3)), 3e-4);
}

TEST(ReferenceMotion, AQuantityIsItsDerivativeOverTheFrequency) {
  constexpr auto displacement = MotionQuantity::displacement;
  constexpr auto velocity = MotionQuantity::velocity;
  constexpr auto acceleration = MotionQuantity::acceleration;
  EXPECT_EQ(motion_factor(displacement, acceleration, 2.0), std::complex<double>(-4.0, 0.0));
  EXPECT_EQ(motion_factor(velocity, acceleration, 2.0), std::complex<double>(0.0, 2.0));
  EXPECT_EQ(motion_factor(displacement, velocity, 2.0), std::complex<double>(0.0, 2.0));
  EXPECT_EQ(motion_factor(velocity, displacement, 2.0), std::complex<double>(0.0, -0.5));
  EXPECT_EQ(motion_factor(acceleration, displacement, 2.0), std::complex<double>(-0.25, 0.0));
  EXPECT_EQ(motion_factor(velocity, velocity, 2.0), std::complex<double>(1.0, 0.0));
}

TEST(ReferenceMotion, LeavesOutSamplesBesideEndsAndGaps) {
  std::vector<std::int64_t> stamps;
  std::vector<double> values;
  for (std::int64_t i = 0; i < 1000; ++i) {
    if (i < 400 || i >= 450) {
      stamps.push_back(i * 1'000'000);
      values.push_back(static_cast<double>(i));
    }
  }
  const CentredSamples centred = centred_samples(20.0, stamps, values); // half a period is 25 ms
  ASSERT_EQ(centred.values.size(), 400U - 52U + 550U - 52U);
  EXPECT_EQ(centred.values.front(), 26.0);
  EXPECT_EQ(centred.values.back(), 973.0);
  for (std::size_t i = 0; i < centred.values.size(); ++i) {
    EXPECT_TRUE(centred.values[i] < 375.0 || centred.values[i] > 474.0);
    EXPECT_EQ(centred.stamps_ns[i], static_cast<std::int64_t>(centred.values[i]) * 1'000'000);
  }
}

TEST(ReferenceMotion, RefusesWhatItCannotDo) {
  const auto slow = motion_of(record_of(500.0, 5000, 160.0), 160.0);
  ASSERT_FALSE(slow);
  EXPECT_EQ(slow.error().code, ErrorCode::frequency_out_of_range);
  const auto short_one = motion_of(record_of(1e5, 1000, 160.0), 160.0);
  ASSERT_FALSE(short_one);
  EXPECT_EQ(short_one.error().code, ErrorCode::too_few_samples);
  Record backwards = record_of(1e4, 5000, 160.0);
  std::swap(backwards.stamps_ns[7], backwards.stamps_ns[8]);
  const auto turned = motion_of(backwards, 160.0);
  ASSERT_FALSE(turned);
  EXPECT_EQ(turned.error().code, ErrorCode::invalid_argument);
}

} // namespace
} // namespace dyncal::analysis
