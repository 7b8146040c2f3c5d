#include "analysis/sine/unresolved_lines.hpp"

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double duration_s = 2.0;

TEST(UnresolvedLines, AStepBesideTheMainsIsFound) {
  const auto lines = unresolved_lines(50.3, duration_s, 1000.0);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].kind, LineKind::mains);
  EXPECT_EQ(lines[0].line_hz, 50.0);
  EXPECT_NEAR(lines[0].distance_hz, 0.3, 1e-12);
  EXPECT_EQ(unresolved_lines(120.5, duration_s, 1000.0).at(0).order, 2);
  EXPECT_TRUE(unresolved_lines(80.0, duration_s, 1000.0).empty());
  EXPECT_TRUE(unresolved_lines(50.8, duration_s, 1000.0).empty());
  EXPECT_TRUE(unresolved_lines(0.0, duration_s, 1000.0).empty());
}

TEST(UnresolvedLines, FoldedLinesAreFound) {
  // The second harmonic folds onto the excitation at a third of the rate, the fourth at a fifth.
  const auto third = unresolved_lines(333.4, duration_s, 1000.0);
  ASSERT_FALSE(third.empty());
  EXPECT_EQ(third[0].kind, LineKind::harmonic);
  EXPECT_EQ(third[0].order, 2);
  EXPECT_NEAR(third[0].distance_hz, 0.2, 1e-9);
  EXPECT_EQ(unresolved_lines(206.1, duration_s, 1030.5).at(0).order, 4);
  // 450 Hz in a sensor of 403 Hz is at 47 Hz.
  const auto folded = unresolved_lines(47.2, duration_s, 403.0);
  ASSERT_EQ(folded.size(), 1u);
  EXPECT_EQ(folded[0].line_hz, 450.0);
}

struct Hum {
  double line_hz = 50.0;
  double amplitude = 1e-3;
  double frequency_hz = 50.2;
};

std::vector<double> record(const Hum& hum, unsigned seed, std::vector<std::int64_t>& stamps_ns,
                           double& phase_rad) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1e-3);
  std::uniform_real_distribution<double> phase(-std::numbers::pi, std::numbers::pi);
  phase_rad = phase(random);
  const double of_hum = phase(random);
  std::vector<double> values;
  stamps_ns.clear();
  for (int i = 0; i < 2000; ++i) {
    const double t = 1e-3 * i;
    stamps_ns.push_back(1'000'000LL * i);
    values.push_back(std::sin(2.0 * std::numbers::pi * hum.frequency_hz * t + phase_rad) +
                     hum.amplitude * std::sin(2.0 * std::numbers::pi * hum.line_hz * t + of_hum) +
                     noise(random));
  }
  return values;
}

// 0.1 % of hum: without its row 19 to 24 % are covered.
TEST(UnresolvedLines, HumKnownFromAnotherStepIsCovered) {
  std::vector<std::int64_t> stamps_ns;
  double phase_rad = 0.0;
  // Another step, where the line is resolved.
  const Hum other{.frequency_hz = 80.0};
  const auto quiet = record(other, 1, stamps_ns, phase_rad);
  const std::span<const double> quiet_channel[] = {quiet};
  const auto at_other = fit_sine(Frequency::from_hz(80.0), 0, stamps_ns, quiet_channel);
  ASSERT_TRUE(at_other);
  const auto residuals =
      residuals_of(Frequency::from_hz(80.0), at_other->front(), 0, stamps_ns, quiet);
  ASSERT_TRUE(is_resolved(50.0, 0, 80.0, duration_s, 1000.0));
  const auto seen = measure_line(50.0, stamps_ns, residuals);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->amplitude, 1e-3, 4.0 * seen->u_component);
  EXPECT_LT(seen->u_component, 1e-4);

  for (const double frequency_hz : {50.0, 50.2, 50.5, 50.7}) {
    int covered = 0;
    int covered_without = 0;
    constexpr int runs = 300;
    for (unsigned run = 0; run < runs; ++run) {
      const auto values = record({.frequency_hz = frequency_hz}, 100 + run, stamps_ns, phase_rad);
      const std::span<const double> channel[] = {values};
      const auto fit = fit_sine(Frequency::from_hz(frequency_hz), 0, stamps_ns, channel);
      ASSERT_TRUE(fit);
      const auto lines = unresolved_lines(frequency_hz, duration_s, 1000.0);
      ASSERT_EQ(lines.size(), 1u);
      const auto hum =
          line_uncertainty(lines[0], seen->amplitude, fit->front().amplitude(), duration_s);
      const double error = std::abs(fit->front().amplitude() - 1.0);
      const double u = fit->front().u_amplitude();
      covered += error <= 2.0 * std::hypot(u, hum.u_magnitude_rel);
      covered_without += error <= 2.0 * u;
    }
    EXPECT_GE(covered, 0.94 * runs) << frequency_hz;
    if (frequency_hz < 50.3) { // farther away the leakage has zeros
      EXPECT_LT(covered_without, 0.3 * runs) << frequency_hz;
    }
  }
}

TEST(UnresolvedLines, ALineOfNoiseIsAsLargeAsItsUncertaintySays) {
  std::vector<std::int64_t> stamps_ns;
  double phase_rad = 0.0;
  double squares = 0.0;
  constexpr unsigned runs = 200;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const auto values =
        record({.amplitude = 0.0, .frequency_hz = 80.0}, seed, stamps_ns, phase_rad);
    const std::span<const double> channel[] = {values};
    const auto fit = fit_sine(Frequency::from_hz(80.0), 0, stamps_ns, channel);
    ASSERT_TRUE(fit);
    const auto line =
        measure_line(200.0, stamps_ns,
                     residuals_of(Frequency::from_hz(80.0), fit->front(), 0, stamps_ns, values));
    ASSERT_TRUE(line);
    squares += line->amplitude * line->amplitude / (2.0 * line->u_component * line->u_component);
  }
  EXPECT_NEAR(squares / runs, 1.0, 0.25); // chi-squared of 400 degrees of freedom
}

TEST(UnresolvedLines, ALineIsResolvedApartFromTheExcitationAndItsMultiples) {
  EXPECT_TRUE(is_resolved(200.0, 0, 78.0, duration_s, 1000.0));
  EXPECT_FALSE(is_resolved(200.0, 0, 80.0, duration_s, 1000.0));  // its tenth harmonic, folded
  EXPECT_FALSE(is_resolved(200.0, 0, 100.3, duration_s, 1000.0)); // its second harmonic
  EXPECT_FALSE(is_resolved(200.0, 0, 200.5, duration_s, 1000.0));
  EXPECT_FALSE(is_resolved(999.8, 0, 80.0, duration_s, 1000.0)); // folded to the constant
  EXPECT_TRUE(is_resolved(4 * 80.0, 4, 80.0, duration_s, 1000.0));
  EXPECT_FALSE(is_resolved(4 * 200.0, 4, 200.0, duration_s, 1000.0)); // folded onto itself
}

TEST(UnresolvedLines, TheMainsMayWanderTowardsTheExcitation) {
  const auto lines = unresolved_lines(50.04, duration_s, 1000.0);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(line_uncertainty(lines[0], 1.0, 1.0, duration_s).u_phase_rad,
              1.0 / std::numbers::sqrt2, 1e-12);
}

// Against sums over the two halves of a record, at the phase where they differ most.
TEST(UnresolvedLines, ALineBeatsByNoMoreThanThis) {
  for (const double distance_hz : {0.02, 0.1, 0.2, 0.6}) {
    const UnresolvedLine line{LineKind::background, 50.0, 0, distance_hz};
    const double largest = largest_beat_rel(line, 0.01, 2.0, duration_s);
    EXPECT_LE(largest, 0.01 + 1e-12);
    for (double phase = 0.0; phase < 6.28; phase += 0.1) {
      std::complex<double> halves[2];
      for (int i = 0; i < 1000; ++i) {
        const double turns = distance_hz * duration_s * (i + 0.5) / 1000.0;
        halves[i / 500] += 0.005 / 500.0 * std::polar(1.0, 2.0 * std::numbers::pi * turns + phase);
      }
      EXPECT_LE(std::abs(halves[1] - halves[0]), largest) << distance_hz;
      EXPECT_GE(std::abs(halves[1] - halves[0]), distance_hz > 0.2 ? 0.0 : 0.4 * largest);
    }
  }
  const UnresolvedLine at_50_hz{LineKind::mains, 50.0, 1, 0.0}; // that wanders by 50 mHz
  EXPECT_NEAR(largest_beat_rel(at_50_hz, 0.01, 2.0, 2.0), 0.01 * std::sin(0.1 * std::numbers::pi),
              1e-9);
}

TEST(UnresolvedLines, NothingIsMeasuredInAFewSamplesOrOfAConstant) {
  const std::vector<std::int64_t> few{0, 1'000'000, 2'000'000};
  EXPECT_FALSE(measure_line(50.0, few, std::vector<double>(3, 0.1)));
  std::vector<std::int64_t> stamps_ns;
  for (int i = 0; i < 100; ++i) {
    stamps_ns.push_back(20'000'000LL * i);
  }
  EXPECT_FALSE(measure_line(50.0, stamps_ns, std::vector<double>(100, 0.1)));
}

} // namespace
} // namespace dyncal::analysis
