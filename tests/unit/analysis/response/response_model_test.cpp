#include "analysis/response/response_model.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

const std::vector<double> plan{10,   12.5, 16, 20,  25,  31.5, 40,  46.7, 50,
                               53.3, 63,   80, 100, 125, 160,  200, 250};

std::vector<ResponsePoint> measure(const ResponseParameters& truth, double u, unsigned seed,
                                   const std::vector<double>& frequencies = plan) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  std::vector<ResponsePoint> points;
  for (const double f : frequencies) {
    const std::complex<double> error =
        seed ? std::exp(std::complex<double>(u * noise(random), u * noise(random))) : 1.0;
    points.push_back({f, response_at(truth, f) * error, u, u});
  }
  return points;
}

constexpr ResponseParameters mems{
    .gain = 1.02, .delay_s = 0.9e-3, .corner_hz = 0.0, .resonance_hz = 320.0, .damping = 0.75};

TEST(ResponseModel, FindsASecondOrderSystemWithDelay) {
  const auto points = measure(mems, 1e-4, 0);
  const auto fit = fit_response(ResponseKind::second_order, points);
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_NEAR(fit->parameters.gain, mems.gain, 1e-10);
  EXPECT_NEAR(fit->parameters.delay_s, mems.delay_s, 1e-13);
  EXPECT_NEAR(fit->parameters.resonance_hz, mems.resonance_hz, 1e-6);
  EXPECT_NEAR(fit->parameters.damping, mems.damping, 1e-9);
  EXPECT_LT(fit->chi_squared, 1e-9);
}

TEST(ResponseModel, KeepsAnInvertedPolarityInTheGain) {
  ResponseParameters inverted = mems;
  inverted.gain = -0.9;
  const auto fit = fit_response(ResponseKind::second_order, measure(inverted, 1e-4, 0));
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->parameters.gain, -0.9, 1e-9);
}

TEST(ResponseModel, FindsTheFrontEndOfAnAdc) {
  const ResponseParameters adc{
      .gain = 0.16625, .delay_s = 0.15e-6, .corner_hz = 500e3, .resonance_hz = 0.0, .damping = 0.0};
  std::vector<double> frequencies;
  for (double f = 100.0; f < 120e3; f *= 1.26) {
    frequencies.push_back(f);
  }
  const auto fit = fit_response(ResponseKind::first_order, measure(adc, 1e-5, 0, frequencies));
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_NEAR(fit->parameters.corner_hz / 500e3, 1.0, 1e-6);
  EXPECT_NEAR(fit->parameters.delay_s, 0.15e-6, 1e-12);
}

TEST(ResponseModel, CovarianceCoversTheScatterOfTheParameters) {
  constexpr int runs = 120;
  std::vector<int> covered(4, 0);
  const std::vector<double> truth{mems.gain, mems.delay_s, mems.resonance_hz, mems.damping};
  for (unsigned run = 1; run <= runs; ++run) {
    const auto fit = fit_response(ResponseKind::second_order, measure(mems, 3e-4, run));
    ASSERT_TRUE(fit.has_value()) << fit.error().message;
    for (std::size_t k = 0; k < 4; ++k) {
      covered[k] += std::abs(fit->values[k] - truth[k]) <= 2.0 * fit->u[k];
    }
  }
  for (const int count : covered) {
    EXPECT_NEAR(count / static_cast<double>(runs), 0.9545, 0.06);
  }
}

TEST(ResponseModel, ACommonGainGoesInFullIntoTheGain) {
  const auto points = measure(mems, 1e-4, 0);
  const auto alone = fit_response(ResponseKind::second_order, points);
  const auto common = fit_response(ResponseKind::second_order, points,
                                   {.gain_rel = 1e-3, .delay_s = 1e-6, .phase_rad = 0.0});
  ASSERT_TRUE(alone && common);
  EXPECT_NEAR(common->u[0], std::hypot(alone->u[0], 1e-3 * mems.gain), 1e-9);
  EXPECT_NEAR(common->u[1], std::hypot(alone->u[1], 1e-6), 1e-12);
  EXPECT_NEAR(common->u[2], alone->u[2], 1e-6 * alone->u[2]);
}

TEST(ResponseModel, ARobustGroupDelayDisregardsAWrongPoint) {
  const ResponseParameters delay{
      .gain = 1.0, .delay_s = 8.1e-3, .corner_hz = 0.0, .resonance_hz = 0.0, .damping = 0.0};
  auto points = measure(delay, 1e-3, 5);
  points[13].h *= std::polar(1.2, 0.4);
  const auto plain = fit_response(ResponseKind::delay, points);
  const auto robust = fit_response(ResponseKind::delay, points, {}, Loss::tukey);
  ASSERT_TRUE(plain && robust);
  EXPECT_GT(std::abs(plain->parameters.delay_s - 8.1e-3), 10.0 * plain->u[1]);
  EXPECT_NEAR(robust->parameters.delay_s, 8.1e-3, 4.0 * robust->u[1]);
}

TEST(ResponseModel, SaysSoWhenTheModelIsNotTheSensors) {
  const auto fit = fit_response(ResponseKind::delay, measure(mems, 1e-3, 3));
  ASSERT_TRUE(fit.has_value());
  EXPECT_GT(fit->chi_squared, 100.0 * fit->degrees_of_freedom);
}

TEST(ResponseModel, RefusesPointsWithoutUncertainty) {
  auto points = measure(mems, 1e-3, 3);
  points[2].u_phase_rad = 0.0;
  EXPECT_EQ(fit_response(ResponseKind::delay, points).error().code, ErrorCode::invalid_argument);
  EXPECT_FALSE(fit_response(ResponseKind::delay, {}).has_value());
  EXPECT_EQ(
      fit_response(ResponseKind::delay, measure(mems, 1e-3, 3), {.gain_rel = 1e-3}, Loss::huber)
          .error()
          .code,
      ErrorCode::invalid_argument);
}

} // namespace
} // namespace dyncal::analysis
