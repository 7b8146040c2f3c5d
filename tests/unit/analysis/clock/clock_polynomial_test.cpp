#include "analysis/clock/clock_polynomial.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr std::int64_t epoch_ns = 1'700'000'000'000'000'000;

// x(t) = 3 ppm of t, bent by 2 us over +-100 s.
double time_error_s(double t) {
  return 3e-6 * t + 2e-6 * (t / 100.0) * (t / 100.0);
}

std::vector<BlockPhase> blocks(double u_rad, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  std::vector<BlockPhase> result;
  const std::vector<double> frequencies{10, 80, 250, 31.5};
  for (std::size_t step = 0; step < frequencies.size(); ++step) {
    const double w = 2.0 * std::numbers::pi * frequencies[step];
    for (int k = 0; k < 40; ++k) {
      const double t = -100.0 + 50.0 * static_cast<double>(step) + k * 1.25;
      result.push_back(
          {step, epoch_ns + std::llround(t * 1e9), w,
           0.7 * static_cast<double>(step) + w * time_error_s(t) + u_rad * noise(random), u_rad});
    }
  }
  return result;
}

TEST(ClockPolynomial, SeesOneClockThroughStepsOfSeveralFrequencies) {
  const auto fit = fit_clock_polynomial(blocks(1e-5, 1), 2);
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_NEAR(fit->rate_error(epoch_ns), 3e-6, 1e-9);
  // The constant of x is in the phases of the steps, so differences count.
  const double bend = fit->time_error_s(epoch_ns + 90'000'000'000) - fit->time_error_s(epoch_ns);
  EXPECT_NEAR(bend, time_error_s(90.0), 3e-8);
  EXPECT_LT(fit->chi_squared, 2.0 * fit->degrees_of_freedom);
}

TEST(ClockPolynomial, CovarianceCoversTheScatter) {
  int covered = 0;
  constexpr int runs = 100;
  for (unsigned run = 1; run <= runs; ++run) {
    const auto fit = fit_clock_polynomial(blocks(1e-4, run), 2, Loss::none);
    ASSERT_TRUE(fit.has_value());
    const double truth = 2e-6 * fit->half_span_s * fit->half_span_s / 1e4;
    covered += std::abs(fit->coefficients_s[1] - truth) <= 2.0 * std::sqrt(fit->covariance[3]);
  }
  EXPECT_GE(covered, 89);
}

TEST(ClockPolynomial, AClockStepShowsInTheResiduals) {
  auto disturbed = blocks(1e-5, 3);
  for (std::size_t i = 90; i < 95; ++i) {
    disturbed[i].phase_rad += disturbed[i].angular_frequency * 5e-6;
  }
  const auto fit = fit_clock_polynomial(disturbed, 2);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->residuals_s[92], 5e-6, 3e-7);
  EXPECT_LT(std::abs(fit->residuals_s[70]), 3e-7);
}

TEST(ClockPolynomial, RefusesWhatItCannotUse) {
  EXPECT_FALSE(fit_clock_polynomial({}, 1).has_value());
  EXPECT_FALSE(fit_clock_polynomial(blocks(1e-5, 1), 0).has_value());
  auto wrong = blocks(1e-5, 1);
  wrong[0].u_phase_rad = 0.0;
  EXPECT_FALSE(fit_clock_polynomial(wrong, 1).has_value());
}

} // namespace
} // namespace dyncal::analysis
