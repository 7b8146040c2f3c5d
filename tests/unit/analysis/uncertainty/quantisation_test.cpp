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

constexpr double own_noise = 0.28867513459481287; // 1 / sqrt(12): no dither

std::vector<std::int64_t> at_1_ks(int samples) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < samples; ++i) {
    stamps.push_back(1'000'000LL * i);
  }
  return stamps;
}

QuantisationUncertainty of_steps(double steps, double residual_sd, double resolution = 1.0) {
  return quantisation_uncertainty(steps, residual_sd, resolution, *Frequency::parse("31.7"),
                                  at_1_ks(1500));
}

// The phase that a fit finds wrong, over many phases and offsets of a sine in steps of 1.
double rms_phase_error(double steps, double frequency_hz, const std::vector<std::int64_t>& stamps) {
  double squares = 0.0;
  constexpr int runs = 400;
  std::vector<double> values(stamps.size());
  for (int run = 0; run < runs; ++run) {
    const double phase_rad = 2.0 * pi * std::fmod(run * 0.754877666, 1.0);
    const double offset = std::fmod(run * 0.569840291, 1.0);
    const double size = steps - 0.5 + std::fmod(run * 0.438744, 1.0);
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const double turn = 2.0 * pi * frequency_hz * static_cast<double>(stamps[i]) * 1e-9;
      values[i] = std::round(size * std::sin(turn + phase_rad) + offset);
    }
    const std::array<std::span<const double>, 1> channels{values};
    const auto fit = fit_sine(Frequency::from_hz(frequency_hz), 0, stamps, channels);
    const double error = std::remainder(fit->front().phase_rad() - phase_rad, 2.0 * pi);
    squares += error * error;
  }
  return std::sqrt(squares / runs);
}

TEST(Quantisation, TheAmplitudeTakesTheBoundAsARectangle) {
  EXPECT_NEAR(of_steps(25.0, own_noise).u_amplitude, 0.53 / 5.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(of_steps(0.1, own_noise).u_amplitude, 2.0 / pi / std::sqrt(3.0), 1e-12);
}

// From a sine that is met at all phases to one whose eight phases are the same in every period.
TEST(Quantisation, ThePhaseIsWrongAsMuchAsTheInstantsMakeIt) {
  const std::vector<std::int64_t> stamps = at_1_ks(1500);
  double most = 0.0, least = 1.0;
  for (const double steps : {3.0, 20.0}) {
    for (const double frequency_hz : {12.5, 31.7, 63.0, 125.0, 160.0, 200.0, 199.93}) {
      const double true_rms = rms_phase_error(steps, frequency_hz, stamps);
      const double u =
          quantisation_uncertainty(steps, own_noise, 1.0, Frequency::from_hz(frequency_hz), stamps)
              .u_phase_rad;
      EXPECT_GT(u, 0.5 * true_rms) << steps << " steps, " << frequency_hz << " Hz";
      EXPECT_LT(u, 2.0 * true_rms) << steps << " steps, " << frequency_hz << " Hz";
      most = std::max(most, u * steps);
      least = std::min(least, u * steps);
    }
  }
  EXPECT_GT(most, 30.0 * least); // no formula of q / A alone would do
}

TEST(Quantisation, ALongRecordIsNoWorseThanItsBeginning) {
  const QuantisationUncertainty u =
      quantisation_uncertainty(20.0, own_noise, 1.0, *Frequency::parse("31.7"), at_1_ks(100'000));
  EXPECT_GT(u.u_phase_rad, 0.0);
  EXPECT_LT(u.u_phase_rad, of_steps(20.0, own_noise).u_phase_rad);
}

TEST(Quantisation, NoiseHidesTheSteps) {
  EXPECT_EQ(of_steps(25.0, 0.6).u_amplitude, 0.0);
  EXPECT_EQ(of_steps(25.0, 0.6).u_phase_rad, 0.0);
  const QuantisationUncertainty little = of_steps(25.0, 0.3);
  const QuantisationUncertainty more = of_steps(25.0, 0.45);
  EXPECT_GT(little.u_amplitude, more.u_amplitude);
  EXPECT_GT(little.u_phase_rad, more.u_phase_rad);
  EXPECT_GT(more.u_amplitude, 0.0);
  EXPECT_EQ(of_steps(25.0, 0.0, 0.0).u_amplitude, 0.0);
}

} // namespace
} // namespace dyncal::analysis
