#include "services/views/signals/spectrum.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

constexpr double rate_hz = 10'000.0;

std::vector<double> sine(double hz, double second, double third, double noise = 0.0) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, noise > 0.0 ? noise : 1.0);
  std::vector<double> values;
  for (int i = 0; i < 20'000; ++i) {
    const double angle = 2.0 * std::numbers::pi * hz * i / rate_hz;
    values.push_back(9.81 + std::sin(angle) + second * std::sin(2.0 * angle) +
                     third * std::cos(3.0 * angle) + (noise > 0.0 ? normal(random) : 0.0));
  }
  return values;
}

TEST(Spectrum, FindsASineOfKnownDistortionWhereverItLies) {
  for (const double hz : {16.0, 80.3, 199.87, 1000.0}) {
    const auto spectrum = spectrum_of(sine(hz, 0.01, 0.002), rate_hz);
    ASSERT_TRUE(spectrum) << hz;
    EXPECT_NEAR(spectrum->fundamental_hz, hz, 0.05) << hz;
    EXPECT_NEAR(spectrum->amplitude, 1.0, 1e-4) << hz;
    EXPECT_NEAR(spectrum->thd, std::hypot(0.01, 0.002), 1e-5) << hz;
    EXPECT_LT(spectrum->noise_floor, 1e-5) << hz;
    EXPECT_NEAR(spectrum->resolution_hz, 2.0 * rate_hz / 16'384.0, 0.01) << hz;
  }
}

TEST(Spectrum, HasTheNoiseFloorOfWhiteNoise) {
  const auto spectrum = spectrum_of(sine(80.3, 0.0, 0.0, 0.01), rate_hz);
  ASSERT_TRUE(spectrum);
  // Lines of noise with standard deviation s: |X|^2 is exponential about N s^2 mean(w^2).
  const double expected = 2.0 * 0.01 * std::sqrt(std::log(2.0) * 2.0044 / 16'384.0);
  EXPECT_NEAR(spectrum->noise_floor, expected, 0.05 * expected);
  EXPECT_NEAR(spectrum->amplitude, 1.0, 1e-3);
}

TEST(Spectrum, KeepsPeaksWhenLinesAreTakenTogether) {
  const auto spectrum = spectrum_of(sine(1000.0, 0.0, 0.0), rate_hz, 100);
  ASSERT_TRUE(spectrum);
  EXPECT_LE(spectrum->lines.size(), 100U);
  double highest = 0.0;
  for (const auto& [hz, amplitude] : spectrum->lines) {
    highest = std::max(highest, amplitude);
  }
  EXPECT_GT(highest, 0.8) << "a line between two bins loses up to 1.6 dB";
}

TEST(Spectrum, NeedsSamplesAndARate) {
  EXPECT_FALSE(spectrum_of(std::vector<double>(63, 1.0), rate_hz));
  EXPECT_FALSE(spectrum_of(std::vector<double>(640, 1.0), 0.0));
  const auto constant = spectrum_of(std::vector<double>(640, 1.0), rate_hz);
  ASSERT_TRUE(constant);
  EXPECT_EQ(constant->thd, 0.0);
}

} // namespace
} // namespace dyncal::inline views
