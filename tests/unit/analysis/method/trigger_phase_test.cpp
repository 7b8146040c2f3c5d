#include "analysis/method/trigger_phase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double frequency_hz = 160.0;
constexpr double beta_rad = -0.02;
constexpr double offset_v = 0.4;
constexpr std::size_t samples = 800;

struct Recorded {
  std::vector<double> volts;
  double interval_s = 0.0;

  [[nodiscard]] SyncTrace trace() const { return {-80.0 * interval_s, interval_s, volts}; }
};

// Some periods of a sync whose second harmonic is a part of it; a tenth lies before the trigger.
Recorded recorded(double periods, double part, double of_phase_rad) {
  Recorded result{{}, periods / frequency_hz / static_cast<double>(samples)};
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = (static_cast<double>(i) - 80.0) * result.interval_s;
    const double turn = 2.0 * std::numbers::pi * frequency_hz * t + beta_rad;
    result.volts.push_back(offset_v + 5.0 * std::sin(turn) +
                           5.0 * part * std::sin(2.0 * turn + of_phase_rad));
  }
  return result;
}

double error_of(const Recorded& one) {
  const auto trigger = fit_trigger(one.trace(), Frequency::from_hz(frequency_hz));
  EXPECT_TRUE(trigger);
  return std::arg(trigger->sync) - beta_rad;
}

TEST(TriggerPhase, HarmonicsDoNotTurnTheFundamentalOfAWholePeriod) {
  for (const double periods : {1.02, 1.3, 1.7, 2.0, 2.4, 7.6}) {
    for (const double phase : {0.0, 1.0, 2.0, 3.0}) {
      EXPECT_NEAR(error_of(recorded(periods, 0.03, phase)), 0.0, 1e-9) << periods;
    }
    EXPECT_EQ(leak_rad(recorded(periods, 0.0, 0.0).trace(), Frequency::from_hz(frequency_hz)), 0.0);
  }
}

TEST(TriggerPhase, InLessThanAPeriodTheLeakBoundsWhatTheyDo) {
  for (const double periods : {0.4, 0.6, 0.8, 0.95}) {
    double worst = 0.0;
    for (double phase = 0.0; phase < 6.2; phase += 0.1) {
      worst = std::max(worst, std::abs(error_of(recorded(periods, 0.001, phase))));
    }
    const double leak =
        leak_rad(recorded(periods, 0.0, 0.0).trace(), Frequency::from_hz(frequency_hz));
    EXPECT_LE(worst, 1.02 * 0.001 * leak) << periods;
    EXPECT_GE(worst, 0.2 * 0.001 * leak) << periods; // the third harmonic may be the worse one
    EXPECT_GT(worst, 5e-5) << periods;
  }
}

} // namespace
} // namespace dyncal::analysis
