#include "analysis/method/nominal_frequency.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/equidistant_axis.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

// The clock of the paper: 996.96 us instead of 1 ms, the sensor runs 3049 ppm fast and senses 80 Hz
// as 79.757 Hz.
TEST(NominalFrequency, AFastClockSensesTheExcitationTooLow) {
  constexpr double real_rate = 1.0 / 996.96e-6;
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 1e-3);
  std::vector<double> samples;
  for (int i = 0; i < 10'000; ++i) {
    samples.push_back(std::sin(2.0 * std::numbers::pi * 80.0 * i / real_rate + 1.0) +
                      noise(random));
  }
  const EquidistantAxis axis(1e-3);
  const std::vector<std::int64_t> stamps_ns = axis.stamps_ns(samples.size());
  const std::array<std::span<const double>, 1> channels{samples};
  const auto fit =
      fit_sine_and_frequency(axis.on_axis(80.0), 0.05, stamps_ns.back() / 2, stamps_ns, channels);
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  const auto result = real_rate_from_apparent_frequency(
      1000.0, 80.0, 0.0, axis.hz(fit->frequency.hz()), axis.hz(fit->u_frequency_hz));
  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_NEAR(result->apparent_hz, 80.0 * 1000.0 / real_rate, 1e-5);
  EXPECT_NEAR(result->real_rate_hz, real_rate, 4.0 * result->u_real_rate_hz);
  EXPECT_LT(result->u_real_rate_hz, 1e-4);
  EXPECT_NEAR(result->lambda, 1.003049, 1e-6);
}

TEST(NominalFrequency, UncertaintiesOfBothFrequenciesCount) {
  const auto result =
      real_rate_from_apparent_frequency(2000.0, 80.0, 80.0 * 3e-6, 77.6, 77.6 * 4e-6);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->lambda, 80.0 / 77.6, 1e-15);
  EXPECT_NEAR(result->real_rate_hz, 2000.0 * 80.0 / 77.6, 1e-10);
  EXPECT_NEAR(result->u_real_rate_hz / result->real_rate_hz, 5e-6, 1e-15);
}

TEST(NominalFrequency, RefusesWhatIsNotPositive) {
  EXPECT_FALSE(real_rate_from_apparent_frequency(0.0, 80.0, 0.0, 80.0, 0.0).has_value());
  EXPECT_FALSE(real_rate_from_apparent_frequency(1000.0, -80.0, 0.0, 80.0, 0.0).has_value());
  EXPECT_FALSE(real_rate_from_apparent_frequency(1000.0, 80.0, 0.0, 0.0, 0.0).has_value());
}

} // namespace
} // namespace dyncal::analysis
