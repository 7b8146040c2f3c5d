#include "analysis/interferometer/reference_motion.hpp"

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
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

MotionSettings settings_of(const Motion& motion) {
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

TEST(ReferenceMotion, SlowMotionOfTheTableIsNoExcitation) {
  // 1.2 um within the record, 400 times the excitation's displacement.
  Motion motion{1000.0, 0.1, 0.4, 1e5, 1.0, 1e-6, 1.0, 0.05};
  const auto result = run(motion, 1);
  ASSERT_TRUE(result);
  const std::complex<double> ratio = result->acceleration / true_acceleration(motion);
  EXPECT_LT(std::abs(ratio - 1.0), 4.0 * std::hypot(result->u_magnitude_rel, result->u_phase_rad));
  EXPECT_LT(std::abs(ratio - 1.0), 0.05);
}

TEST(ReferenceMotion, SyncKeepsAmplitudeAndPhase) {
  for (const double rate_hz : {1000.0, 1e4, 2e5}) {
    Motion motion;
    motion.sample_rate_hz = rate_hz;
    motion.seconds = 0.2;
    motion.acceleration_m_s2 = 0.5;
    const auto result = run(motion, 2);
    ASSERT_TRUE(result);
    EXPECT_NEAR(std::abs(result->sync), 1.0, 1e-4) << rate_hz;
    EXPECT_NEAR(std::arg(result->sync), simulated::sync_phase_rad, 1e-4) << rate_hz;
  }
}

TEST(ReferenceMotion, TheDirectionTurnsTheAcceleration) {
  const Motion motion;
  const Detectors detectors;
  const auto signals = simulate(motion, detectors, 3);
  MotionSettings settings = settings_of(motion);
  settings.displacement_per_turn_m = -settings.displacement_per_turn_m;
  const auto turned = chain(settings, detectors.ellipse, signals.u1, signals.u2, signals.sync);
  ASSERT_TRUE(turned);
  EXPECT_LT(std::abs(turned->acceleration / true_acceleration(motion) + 1.0), 1e-5);
}

TEST(ReferenceMotion, DecimatesToFourToEightTimesTheFrequency) {
  for (double rate_hz = 640.0; rate_hz < 2e7; rate_hz *= 1.07) {
    const auto motion = ReferenceMotion::of_step({160.0, rate_hz, 3e-7});
    ASSERT_TRUE(motion);
    EXPECT_GE(motion->decimated_rate_hz(), 640.0 * (1.0 - 1e-12)) << rate_hz;
    EXPECT_LE(motion->decimated_rate_hz(), 1280.0 * (1.0 + 1e-12)) << rate_hz;
  }
}

TEST(ReferenceMotion, RefusesWhatItCannotDo) {
  const auto slow = ReferenceMotion::of_step({160.0, 500.0, 3e-7});
  ASSERT_FALSE(slow);
  EXPECT_EQ(slow.error().code, ErrorCode::frequency_out_of_range);
  EXPECT_FALSE(ReferenceMotion::of_step({0.0, 500.0, 3e-7}));
  EXPECT_FALSE(ReferenceMotion::of_step({10.0, 500.0, 0.0}));
  auto empty = ReferenceMotion::of_step({160.0, 1e6, 3e-7});
  ASSERT_TRUE(empty);
  empty->push_turns(std::vector<double>(5000, 1.0));
  empty->push_sync(std::vector<double>(5000, 1.0));
  const auto decimated = empty->decimated();
  ASSERT_FALSE(decimated);
  EXPECT_EQ(decimated.error().code, ErrorCode::too_few_samples);
}

} // namespace
} // namespace dyncal::analysis
