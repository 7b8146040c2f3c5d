#include "analysis/response/response_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/analysis/response/measured_response.hpp"

namespace dyncal::analysis {
namespace {

using tests::measured_response;
constexpr ResponseParameters mems = tests::mems_sensor;

TEST(ResponseFit, FindsASecondOrderSystemWithDelay) {
  const auto points = measured_response(mems, 1e-4, 0);
  const auto fit = fit_response(ResponseKind::second_order_with_delay, points);
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_NEAR(fit->parameters.gain, mems.gain, 1e-10);
  EXPECT_NEAR(fit->parameters.delay_s, mems.delay_s, 1e-13);
  EXPECT_NEAR(fit->parameters.resonance_hz, mems.resonance_hz, 1e-6);
  EXPECT_NEAR(fit->parameters.damping, mems.damping, 1e-9);
  EXPECT_LT(fit->chi_squared, 1e-9);
}

TEST(ResponseFit, KeepsAnInvertedPolarityInTheGain) {
  ResponseParameters inverted = mems;
  inverted.gain = -0.9;
  const auto fit =
      fit_response(ResponseKind::second_order_with_delay, measured_response(inverted, 1e-4, 0));
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->parameters.gain, -0.9, 1e-9);
}

TEST(ResponseFit, FindsTheFrontEndOfAnAdc) {
  const ResponseParameters adc{
      .gain = 0.16625, .delay_s = 0.15e-6, .corner_hz = 500e3, .resonance_hz = 0.0, .damping = 0.0};
  std::vector<double> frequencies;
  for (double f = 100.0; f < 120e3; f *= 1.26) {
    frequencies.push_back(f);
  }
  const auto fit = fit_response(ResponseKind::first_order_with_delay,
                                measured_response(adc, 1e-5, 0, frequencies));
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_NEAR(fit->parameters.corner_hz / 500e3, 1.0, 1e-6);
  EXPECT_NEAR(fit->parameters.delay_s, 0.15e-6, 1e-12);
}

// Every kind from values without error, in both polarities.
class ExactResponse : public testing::TestWithParam<ResponseKind> {};

ResponseParameters example_of(ResponseKind kind, double sign) {
  return {.gain = sign * 0.83,
          .delay_s = has_delay(kind) ? 2.3e-3 : 0.0,
          .corner_hz = has_first_order(kind) ? 410.0 : 0.0,
          .resonance_hz = has_second_order(kind) ? 190.0 : 0.0,
          .damping = has_second_order(kind) ? 0.31 : 0.0};
}

TEST_P(ExactResponse, IsFoundAgain) {
  for (const double sign : {1.0, -1.0}) {
    const ResponseParameters truth = example_of(GetParam(), sign);
    const auto fit = fit_response(GetParam(), measured_response(truth, 1e-4, 0));
    ASSERT_TRUE(fit.has_value()) << fit.error().message;
    EXPECT_NEAR(fit->parameters.gain / truth.gain, 1.0, 1e-9);
    EXPECT_NEAR(fit->parameters.delay_s, truth.delay_s, 1e-9 * 2.3e-3);
    EXPECT_NEAR(fit->parameters.corner_hz, truth.corner_hz, 1e-9 * 410.0);
    EXPECT_NEAR(fit->parameters.resonance_hz, truth.resonance_hz, 1e-9 * 190.0);
    EXPECT_NEAR(fit->parameters.damping, truth.damping, 1e-9);
    EXPECT_LT(fit->chi_squared, 1e-12);
    EXPECT_TRUE(fit->undetermined.empty());
    EXPECT_TRUE(fit->other_delays.empty());
    ASSERT_EQ(fit->values.size(), parameter_count(GetParam()));
    EXPECT_EQ(fit->degrees_of_freedom, 34.0 - static_cast<double>(parameter_count(GetParam())));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ExactResponse, testing::ValuesIn(all_response_kinds),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

TEST(ResponseFit, SlopesAreThoseOfTheModel) {
  constexpr auto kind = ResponseKind::second_and_first_order_with_delay;
  const ResponseParameters at = example_of(kind, -1.0);
  const std::array<double ResponseParameters::*, 5> members{
      &ResponseParameters::gain, &ResponseParameters::delay_s, &ResponseParameters::corner_hz,
      &ResponseParameters::resonance_hz, &ResponseParameters::damping};
  for (const double f : {0.0, 12.0, 190.0, 700.0}) {
    const auto slopes = log_slopes(kind, at, f);
    ASSERT_EQ(slopes.size(), members.size());
    for (std::size_t k = 0; k < members.size(); ++k) {
      ResponseParameters above = at, below = at;
      const double step = 1e-5 * std::abs(at.*members[k]);
      above.*members[k] += step;
      below.*members[k] -= step;
      const std::complex<double> expected =
          std::log(response_at(above, f) / response_at(below, f)) / (2.0 * step);
      EXPECT_NEAR(std::abs(slopes[k] - expected), 0.0, 1e-7 * std::abs(expected) + 1e-9)
          << f << ' ' << k;
    }
  }
}

// 95.45 % of the intervals of 2 u hold the truth, within what 400 draws allow (4 standard
// deviations), with and without errors that all points have in common.
TEST(ResponseFit, UCoversTheScatterOfTheParameters) {
  constexpr int runs = 400;
  const CommonResponseUncertainty shared{.gain_rel = 2e-3, .delay_s = 4e-6, .phase_rad = 0.0};
  const std::vector<double> truth{mems.gain, mems.delay_s, mems.resonance_hz, mems.damping};
  for (const CommonResponseUncertainty& common : {CommonResponseUncertainty{}, shared}) {
    std::vector<int> covered(4, 0);
    double chi_squared = 0.0;
    for (unsigned run = 1; run <= runs; ++run) {
      const auto points = measured_response(mems, 3e-4, run, tests::third_octaves, common);
      const auto fit = fit_response(ResponseKind::second_order_with_delay, points, common);
      ASSERT_TRUE(fit.has_value()) << fit.error().message;
      chi_squared += fit->chi_squared / runs;
      for (std::size_t k = 0; k < 4; ++k) {
        covered[k] +=
            std::abs(fit->values[k] - truth[k]) <= 2.0 * 0.5 * fit->of_values[k].expanded();
      }
    }
    for (const int count : covered) {
      EXPECT_NEAR(count / static_cast<double>(runs), 0.9545, 0.042);
    }
    EXPECT_NEAR(chi_squared, 30.0, 4.0 * std::sqrt(60.0 / runs));
  }
}

// Phases of many turns between distant frequencies: 8.1 ms are 1.2 turns from 100 to 250 Hz.
TEST(ResponseFit, WholeTurnsBetweenDistantFrequenciesDoNotFoolIt) {
  const std::vector<double> distant{10, 13, 40, 110, 250, 700, 1000};
  for (const double delay_s : {0.2e-3, 8.1e-3, 31.7e-3, -1e-6}) {
    ResponseParameters truth = mems;
    truth.delay_s = delay_s;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const auto fit = fit_response(ResponseKind::second_order_with_delay,
                                    measured_response(truth, 2e-3, seed, distant));
      ASSERT_TRUE(fit.has_value()) << fit.error().message;
      EXPECT_NEAR(fit->parameters.delay_s, delay_s, 5.0 * 0.5 * fit->of_values[1].expanded())
          << seed;
      EXPECT_TRUE(fit->other_delays.empty());
    }
  }
}

TEST(ResponseFit, SaysWhichOtherDelaysTheFrequenciesAllow) {
  const std::vector<double> grid{100, 200, 300, 400, 500, 600};
  const ResponseParameters truth{.gain = -1.0, .delay_s = 2.2e-3};
  const auto fit = fit_response(ResponseKind::delay, measured_response(truth, 1e-3, 0, grid));
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_NEAR(fit->parameters.delay_s, 2.2e-3, 1e-12);
  EXPECT_LT(fit->parameters.gain, 0.0);
  ASSERT_FALSE(fit->other_delays.empty());
  for (const OtherDelay& other : fit->other_delays) {
    const double turns = (other.delay_s - 2.2e-3) * 100.0;
    EXPECT_NEAR(turns, std::round(turns), 1e-6);
    EXPECT_TRUE(other.polarity_inverted);
  }
}

TEST(ResponseFit, SaysWhichParameterTheValuesDoNotDetermine) {
  const auto points = measured_response({.gain = 1.0, .delay_s = 1e-3}, 1e-3, 0);
  for (const ResponseKind kind :
       {ResponseKind::first_order_with_delay, ResponseKind::second_order_with_delay}) {
    const auto fit = fit_response(kind, points);
    EXPECT_TRUE(fit ? !fit->undetermined.empty() : fit.error().code == ErrorCode::ill_conditioned)
        << name_of(kind);
  }
}

// A common error moves all residuals together; without it each point's own error is left.
TEST(ResponseFit, TakesWhatIsCommonOutOfTheOwnResiduals) {
  const CommonResponseUncertainty common{.gain_rel = 0.0, .delay_s = 20e-6, .phase_rad = 0.0};
  const ResponseParameters truth{.gain = 1.0, .delay_s = 0.0};
  std::vector<ResponsePoint> points = measured_response(truth, 1e-4, 0);
  for (ResponsePoint& point : points) {
    point.h *= std::polar(1.0, -6.283185307179586 * point.frequency_hz * 15e-6);
  }
  const auto fit = fit_response(ResponseKind::gain, points, common);
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_NEAR(fit->residuals.back().phase_rad, -6.283185307179586 * 250.0 * 15e-6, 1e-9);
  EXPECT_LT(std::abs(fit->residuals.back().own_phase_rad), 1e-4);
  EXPECT_NEAR(fit->chi_squared, 0.5625, 0.01); // (15 / 20)^2
}

TEST(ResponseFit, DoesNotDependOnTheOrderOfThePoints) {
  auto points = measured_response(mems, 3e-4, 7);
  const auto rising = fit_response(ResponseKind::second_order_with_delay, points);
  std::reverse(points.begin(), points.end());
  const auto falling = fit_response(ResponseKind::second_order_with_delay, points);
  ASSERT_TRUE(rising && falling);
  EXPECT_EQ(rising->values, falling->values);
  EXPECT_EQ(rising->residuals.front().phase_rad, falling->residuals.back().phase_rad);
}

TEST(ResponseFit, ACommonGainGoesInFullIntoTheGain) {
  const auto points = measured_response(mems, 1e-4, 0);
  const auto alone = fit_response(ResponseKind::second_order_with_delay, points);
  const auto common = fit_response(ResponseKind::second_order_with_delay, points,
                                   {.gain_rel = 1e-3, .delay_s = 1e-6, .phase_rad = 0.0});
  ASSERT_TRUE(alone && common);
  EXPECT_NEAR(0.5 * common->of_values[0].expanded(),
              std::hypot(0.5 * alone->of_values[0].expanded(), 1e-3 * mems.gain), 1e-9);
  EXPECT_NEAR(0.5 * common->of_values[1].expanded(),
              std::hypot(0.5 * alone->of_values[1].expanded(), 1e-6), 1e-12);
  EXPECT_NEAR(0.5 * common->of_values[2].expanded(), 0.5 * alone->of_values[2].expanded(),
              1e-6 * 0.5 * alone->of_values[2].expanded());
}

// u of every point from one scatter: the gain is known no better than each of them, and U is as if
// they were known well, for u of the points is U / 2.
TEST(ResponseFit, AParameterIsKnownAsWellAsItsPoints) {
  auto points = measured_response(mems, 1e-4, 0);
  const auto well = fit_response(ResponseKind::gain, points);
  for (ResponsePoint& point : points) {
    point.magnitude_degrees_of_freedom = point.phase_degrees_of_freedom = 3.0;
  }
  const auto few = fit_response(ResponseKind::gain, points);
  ASSERT_TRUE(well && few);
  EXPECT_EQ(well->of_values[0].k, 2.0);
  EXPECT_NEAR(few->of_values[0].degrees_of_freedom, 3.0, 1e-9);
  EXPECT_NEAR(few->of_values[0].k, coverage_factor(3.0), 1e-9);
  EXPECT_NEAR(few->of_values[0].expanded(), well->of_values[0].expanded(),
              1e-9 * well->of_values[0].expanded());
}

TEST(ResponseFit, ARobustGroupDelayDisregardsAWrongPoint) {
  const ResponseParameters delay{
      .gain = 1.0, .delay_s = 8.1e-3, .corner_hz = 0.0, .resonance_hz = 0.0, .damping = 0.0};
  auto points = measured_response(delay, 1e-3, 5);
  points[13].h *= std::polar(1.2, 0.4);
  const auto plain = fit_response(ResponseKind::delay, points);
  const auto robust = fit_response(ResponseKind::delay, points, {}, Loss::tukey);
  ASSERT_TRUE(plain && robust);
  EXPECT_GT(std::abs(plain->parameters.delay_s - 8.1e-3),
            10.0 * 0.5 * plain->of_values[1].expanded());
  EXPECT_NEAR(robust->parameters.delay_s, 8.1e-3, 4.0 * 0.5 * robust->of_values[1].expanded());
}

TEST(ResponseFit, SaysSoWhenTheModelIsNotTheSensors) {
  const auto fit = fit_response(ResponseKind::delay, measured_response(mems, 1e-3, 3));
  ASSERT_TRUE(fit.has_value());
  EXPECT_GT(fit->chi_squared, 100.0 * fit->degrees_of_freedom);
}

TEST(ResponseFit, RefusesPointsWithoutUncertainty) {
  auto points = measured_response(mems, 1e-3, 3);
  points[2].u_phase_rad = 0.0;
  EXPECT_EQ(fit_response(ResponseKind::delay, points).error().code, ErrorCode::invalid_argument);
  EXPECT_FALSE(fit_response(ResponseKind::delay, {}).has_value());
  EXPECT_EQ(fit_response(ResponseKind::delay, measured_response(mems, 1e-3, 3), {.gain_rel = 1e-3},
                         Loss::huber)
                .error()
                .code,
            ErrorCode::invalid_argument);
}

} // namespace
} // namespace dyncal::analysis
