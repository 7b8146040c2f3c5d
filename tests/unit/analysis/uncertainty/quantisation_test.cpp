#include "analysis/uncertainty/quantisation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

// Amplitude that a fit finds in a sine of amplitude `steps` quantised in steps of 1.
double quantised_amplitude(double steps, double offset) {
  std::vector<std::int64_t> stamps;
  std::vector<double> values;
  for (int i = 0; i < 20'000; ++i) { // 7 periods, so many phases that they do not matter
    stamps.push_back(1000ll * i);
    values.push_back(std::round(steps * std::sin(2.0 * pi * 350.0 * i * 1e-6) + offset));
  }
  const std::array<std::span<const double>, 1> channels{values};
  return fit_sine(*Frequency::parse("350"), 0, stamps, channels)->front().amplitude();
}

// 0.53 q / sqrt(A / q) bounds what quantisation does to the amplitude at any offset, and is not
// much larger than that.
TEST(Quantisation, TheBoundOfTheAmplitudeHoldsAtEveryOffsetAndIsTight) {
  for (const double steps : {1.3, 2.7, 6.1, 20.0}) {
    const double bound = 0.53 / std::sqrt(steps);
    double worst = 0.0;
    for (double fraction = 0.0; fraction < 1.0; fraction += 0.05) {
      for (double offset = 0.0; offset < 1.0; offset += 0.1) {
        const double size = steps + fraction;
        worst = std::max(worst, std::abs(quantised_amplitude(size, offset) - size));
      }
    }
    EXPECT_LT(worst, 1.05 * bound) << steps;
    EXPECT_GT(worst, 0.6 * bound) << steps;
  }
}

TEST(Quantisation, TheAmplitudeTakesTheBoundAsARectangle) {
  constexpr double own_noise = 0.28867513459481287; // 1 / sqrt(12): no dither
  const QuantisationUncertainty u = quantisation_uncertainty(25.0, own_noise, 1.0, 100.0);
  EXPECT_NEAR(u.u_amplitude, 0.53 / 5.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(u.u_phase_rad, std::sqrt(2.0 / 100.0 / 12.0) / 25.0, 1e-12);
  const QuantisationUncertainty weak = quantisation_uncertainty(0.1, own_noise, 1.0, 100.0);
  EXPECT_NEAR(weak.u_amplitude, 2.0 / pi / std::sqrt(3.0), 1e-12);
}

TEST(Quantisation, NoiseHidesTheSteps) {
  EXPECT_EQ(quantisation_uncertainty(25.0, 0.6, 1.0, 100.0).u_amplitude, 0.0);
  const double little = quantisation_uncertainty(25.0, 0.3, 1.0, 100.0).u_amplitude;
  const double more = quantisation_uncertainty(25.0, 0.45, 1.0, 100.0).u_amplitude;
  EXPECT_GT(little, more);
  EXPECT_GT(more, 0.0);
  EXPECT_EQ(quantisation_uncertainty(25.0, 0.0, 0.0, 100.0).u_amplitude, 0.0);
}

} // namespace
} // namespace dyncal::analysis
