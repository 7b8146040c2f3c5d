#include "analysis/sine/schroeder_phases.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

double crest_factor(const std::vector<double>& values) {
  double squares = 0.0;
  double peak = 0.0;
  for (const double value : values) {
    squares += value * value;
    peak = std::max(peak, std::abs(value));
  }
  return peak / std::sqrt(squares / static_cast<double>(values.size()));
}

std::vector<MultisineLine> harmonics(int n) {
  const std::vector<double> phases = schroeder_phases(std::vector<double>(n, 1.0));
  std::vector<MultisineLine> lines;
  for (int k = 1; k <= n; ++k) {
    lines.push_back({static_cast<double>(k), 1.0, phases[static_cast<std::size_t>(k - 1)]});
  }
  return lines;
}

// Schroeder 1970: - pi n^2 / N for a flat spectrum, up to a delay.
TEST(SchroederPhases, OfAFlatSpectrumAreQuadratic) {
  const std::vector<double> phases = schroeder_phases(std::vector<double>(16, 2.0));
  for (std::size_t n = 2; n < phases.size(); ++n) {
    const double second = phases[n] - 2.0 * phases[n - 1] + phases[n - 2];
    EXPECT_NEAR(std::remainder(second + 2.0 * std::numbers::pi / 16.0, 2.0 * std::numbers::pi), 0.0,
                1e-12);
  }
}

TEST(SchroederPhases, KeepThePeaksOfAFlatSpectrumLow) {
  std::vector<MultisineLine> lines = harmonics(30);
  EXPECT_LT(crest_factor(multisine_waveform(lines, 1.0, 4096)), 1.9);
  for (MultisineLine& line : lines) {
    line.phase_rad = std::numbers::pi / 2.0;
  }
  EXPECT_GT(crest_factor(multisine_waveform(lines, 1.0, 4096)), 7.0);
}

TEST(SchroederPhases, WaveformHoldsItsLinesAndNoOthers) {
  const std::vector<MultisineLine> lines{{10.1, 0.7, 0.3}, {33.1, 1.1, -2.0}};
  constexpr std::size_t n = 5000;
  const std::vector<double> waveform = multisine_waveform(lines, 10.0, n);
  for (int k = 1; k < 400; ++k) {
    std::complex<double> sum;
    for (std::size_t i = 0; i < n; ++i) {
      sum += waveform[i] *
             std::polar(2.0 / n, -2.0 * std::numbers::pi * k * static_cast<double>(i) / n);
    }
    std::complex<double> expected;
    for (const MultisineLine& line : lines) {
      if (std::lround(10.0 * line.frequency_hz) == k) {
        expected = std::polar(line.amplitude, line.phase_rad - std::numbers::pi / 2.0);
      }
    }
    EXPECT_LT(std::abs(sum - expected), 1e-10) << k;
  }
}

} // namespace
} // namespace dyncal::analysis
