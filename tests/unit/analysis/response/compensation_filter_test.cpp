#include "analysis/response/compensation_filter.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/analysis/response/measured_response.hpp"

namespace dyncal::analysis {
namespace {

using tests::measured_response;
constexpr double rate_hz = 1000.0;

FittedResponse fitted(unsigned seed, double u = 3e-4,
                      const ResponseParameters& truth = tests::mems_sensor) {
  auto fit = fit_response(ResponseKind::second_order_with_delay, measured_response(truth, u, seed));
  EXPECT_TRUE(fit.has_value());
  return *fit;
}

// With errors of 1e-3, seeds 1 to 400; made once.
const std::vector<FittedResponse>& fits() {
  static const std::vector<FittedResponse> all = [] {
    std::vector<FittedResponse> made;
    for (unsigned seed = 1; seed <= 400; ++seed) {
      made.push_back(fitted(seed, 1e-3));
    }
    return made;
  }();
  return all;
}

// Of a sine through the difference equation, without any transform.
std::complex<double> filtered(const CompensationFilter& filter, const ResponseParameters& sensor,
                              double frequency_hz) {
  const double w = 2.0 * std::numbers::pi * frequency_hz;
  const std::complex<double> h = response_at(sensor, frequency_hz);
  constexpr std::size_t samples = 4000;
  std::vector<double> x(samples), y(samples);
  double sine = 0.0, cosine = 0.0;
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) / filter.rate_hz;
    x[n] = std::abs(h) * std::sin(w * t + std::arg(h));
    for (std::size_t k = 0; k < filter.b.size() && k <= n; ++k) {
      y[n] += filter.b[k] * x[n - k];
    }
    for (std::size_t k = 1; k < filter.a.size() && k <= n; ++k) {
      y[n] -= filter.a[k] * y[n - k];
    }
    if (n >= samples / 2) { // whole periods
      const double late = t - filter.delay_samples / filter.rate_hz;
      sine += y[n] * std::sin(w * late) * 4.0 / samples;
      cosine += y[n] * std::cos(w * late) * 4.0 / samples;
    }
  }
  return {sine, cosine};
}

class Compensation : public testing::TestWithParam<int> {}; // poles

TEST_P(Compensation, UndoesTheSensorInTheTimeDomain) {
  const FittedResponse fit = fitted(0);
  const auto filter =
      design_compensation(fit, {.rate_hz = rate_hz, .cutoff_hz = 200.0, .poles = GetParam()});
  ASSERT_TRUE(filter.has_value()) << filter.error().message;
  EXPECT_LT(filter->ripple, 1e-3);
  EXPECT_LT(filter->stop_gain, 0.1);
  EXPECT_EQ(filter->a.size(), static_cast<std::size_t>(GetParam()) + 1);
  EXPECT_EQ(filter->a.front(), 1.0);
  for (const double f : {10.0, 50.0, 120.0, 200.0}) {
    const std::complex<double> out = filtered(*filter, tests::mems_sensor, f);
    EXPECT_NEAR(std::abs(out - 1.0), 0.0, filter->ripple + 1e-6) << f;
  }
}

TEST_P(Compensation, AlsoUndoesAnInvertedSensorWithAResonanceInTheBand) {
  const ResponseParameters sensor{
      .gain = -0.2, .delay_s = 4.3e-3, .resonance_hz = 120.0, .damping = 0.2};
  const auto filter = design_compensation(
      fitted(0, 3e-4, sensor), {.rate_hz = 2000.0, .cutoff_hz = 200.0, .poles = GetParam()});
  ASSERT_TRUE(filter.has_value()) << filter.error().message;
  EXPECT_LT(filter->ripple, 5e-3);
  EXPECT_GE(filter->delay_samples, 9); // not before the sensor has answered
  for (const double f : {10.0, 120.0, 200.0}) {
    EXPECT_NEAR(std::abs(filtered(*filter, sensor, f) - 1.0), 0.0, filter->ripple + 1e-5) << f;
  }
}

// The truth through the filter of a fit: 95.45 % of the errors lie within 2 u beside the ripple.
TEST_P(Compensation, UCoversTheErrorOfTheCompensatedResponse) {
  constexpr std::size_t runs = 400;
  const std::vector<double> frequencies{10, 50, 100, 160, 200};
  const std::vector<ResponsePoint> truth =
      measured_response(tests::mems_sensor, 1e-4, 0, frequencies);
  std::vector<int> magnitude(frequencies.size(), 0), phase(frequencies.size(), 0);
  for (std::size_t run = 0; run < runs; ++run) {
    const FittedResponse& fit = fits()[run];
    const auto filter = design_compensation(fit, {.rate_hz = rate_hz,
                                                  .cutoff_hz = 200.0,
                                                  .poles = GetParam(),
                                                  .taps = 33,
                                                  .delay_samples = 18});
    ASSERT_TRUE(filter.has_value());
    const auto points = compensate(*filter, fit, truth);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const CompensatedPoint& p = points[i];
      magnitude[i] += std::abs(p.measured_magnitude_error - p.magnitude_error) <= 2 * p.u_magnitude;
      phase[i] += std::abs(p.measured_phase_error_rad - p.phase_error_rad) <= 2 * p.u_phase_rad;
    }
  }
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    EXPECT_NEAR(magnitude[i] / static_cast<double>(runs), 0.9545, 0.042) << frequencies[i];
    EXPECT_NEAR(phase[i] / static_cast<double>(runs), 0.9545, 0.042) << frequencies[i];
  }
}

// The coefficients of 200 fits scatter as their covariance states.
TEST_P(Compensation, TheCovarianceOfTheCoefficientsIsTheirScatter) {
  constexpr std::size_t runs = 200;
  const CompensationSettings settings{
      .rate_hz = rate_hz, .cutoff_hz = 200.0, .poles = GetParam(), .taps = 17, .delay_samples = 10};
  const auto exact = design_compensation(fitted(0, 1e-3), settings);
  ASSERT_TRUE(exact.has_value());
  const std::size_t taps = exact->b.size();
  std::vector<double> squares(taps, 0.0);
  for (std::size_t run = 0; run < runs; ++run) {
    const auto filter = design_compensation(fits()[run], settings);
    for (std::size_t k = 0; k < taps; ++k) {
      squares[k] += std::pow(filter->b[k] - exact->b[k], 2) / static_cast<double>(runs);
    }
  }
  for (std::size_t k = 0; k < taps; ++k) {
    const double variance = exact->covariance_b[k * taps + k];
    ASSERT_GT(variance, 0.0);
    EXPECT_NEAR(squares[k] / variance, 1.0, 4.0 * std::sqrt(2.0 / static_cast<double>(runs))) << k;
    EXPECT_DOUBLE_EQ(exact->covariance_b[k * taps], exact->covariance_b[k]);
  }
}

INSTANTIATE_TEST_SUITE_P(FirAndIir, Compensation, testing::Values(0, 4));

TEST(CompensationSettings, AreRefusedWithTheirName) {
  const FittedResponse fit = fitted(0);
  EXPECT_EQ(design_compensation(fit, {.rate_hz = 0.0, .cutoff_hz = 1.0}).error().code,
            ErrorCode::invalid_argument);
  EXPECT_NE(design_compensation(fit, {.rate_hz = 300.0, .cutoff_hz = 200.0})
                .error()
                .message.find("below half the sample rate"),
            std::string::npos);
  EXPECT_FALSE(design_compensation(fit, {.rate_hz = rate_hz, .cutoff_hz = 200.0, .taps = 1}));
  EXPECT_FALSE(
      design_compensation(fit, {.rate_hz = rate_hz, .cutoff_hz = 200.0, .delay_samples = -1}));
}

} // namespace
} // namespace dyncal::analysis
