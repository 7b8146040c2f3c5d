#include "analysis/instrument/adc_comparison.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double turn_rad = 2.0 * std::numbers::pi;
constexpr std::int64_t begin_ns = 1'700'000'000'000'000'000;

// What a fit about `at_ns` finds of amplitude sin(w (t - begin - delay)).
SyncPhasor seen(double frequency_hz, double amplitude, double delay_s, std::int64_t at_ns) {
  const double turns = frequency_hz * (static_cast<double>(at_ns - begin_ns) * 1e-9 - delay_s);
  const std::complex<double> phasor = std::polar(amplitude, turn_rad * (turns - std::floor(turns)));
  return {.frequency_hz = frequency_hz,
          .phase_origin_ns = at_ns,
          .sine = phasor.real(),
          .cosine = phasor.imag(),
          .u_sine = 1e-5,
          .u_cosine = 1e-5};
}

TEST(AdcComparison, FindsGainAndLagWhereverTheRecordsLie) {
  for (const double frequency_hz : {1.0, 10.0, 79.3, 200.0, 1000.0}) {
    for (const std::int64_t apart_ns : {-200'000'000, 0, 3'141'593}) {
      const std::int64_t middle_ns = begin_ns + 3'000'000'000;
      const auto compared =
          compare_sync_adc(seen(frequency_hz, 9.75, 0.0, middle_ns),
                           seen(frequency_hz, 1.62, 0.46e-6, middle_ns + apart_ns), 1.0, {});
      ASSERT_TRUE(compared);
      EXPECT_NEAR(compared->point.gain, 1.62 / 9.75, 1e-12);
      EXPECT_NEAR(compared->point.phase_lag_rad, turn_rad * frequency_hz * 0.46e-6, 1e-9)
          << frequency_hz;
      EXPECT_NEAR(compared->sync_vpp, 19.5, 1e-12);
    }
  }
}

TEST(AdcComparison, KeepsWhatStepsHaveInCommonApartFromTheirNoise) {
  const auto compared =
      compare_sync_adc(seen(100.0, 1.0, 0.0, begin_ns), seen(100.0, 1.0, 0.0, begin_ns), 1.0,
                       {.time_scale_s = 30e-9, .acs_delay_s = 40e-9, .acs_gain_rel = 2e-4});
  ASSERT_TRUE(compared);
  EXPECT_NEAR(compared->point.u_phase_lag_rad, turn_rad * 100.0 * 50e-9, 1e-12);
  EXPECT_NEAR(compared->point.u_gain, 2e-4, 1e-12);
  EXPECT_NEAR(compared->noise_phase_rad, std::sqrt(2.0) * 1e-5, 1e-12);
  EXPECT_NEAR(compared->noise_gain, std::sqrt(2.0) * 1e-5, 1e-12);
}

TEST(AdcComparison, AFrequencyThatIsNotKnownMakesThePhaseUncertainOnItsWay) {
  SyncPhasor acs = seen(100.0, 1.0, 0.0, begin_ns);
  acs.u_frequency_hz = 1e-4;
  const auto near = compare_sync_adc(acs, seen(100.0, 1.0, 0.0, begin_ns), 1.0, {});
  const auto far = compare_sync_adc(acs, seen(100.0, 1.0, 0.0, begin_ns + 400'000'000), 1.0, {});
  EXPECT_NEAR(far->noise_phase_rad, std::hypot(near->noise_phase_rad, turn_rad * 1e-4 * 0.2), 1e-9);
}

TEST(AdcComparison, RefusesRecordsThatAreNotOnOneTimeScale) {
  const auto compared = compare_sync_adc(seen(100.0, 1.0, 0.0, begin_ns),
                                         seen(100.0, 1.0, 0.0, begin_ns + 2'000'000'000), 1.0, {});
  ASSERT_FALSE(compared);
  EXPECT_EQ(compared.error().code, ErrorCode::invalid_argument);
  EXPECT_FALSE(compare_sync_adc({}, seen(100.0, 1.0, 0.0, begin_ns), 1.0, {}));
}

} // namespace
} // namespace dyncal::analysis
