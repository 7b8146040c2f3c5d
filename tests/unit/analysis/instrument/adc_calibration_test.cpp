#include "analysis/instrument/adc_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

struct TrueFrontEnd {
  double gain = 0.16625;
  double delay_s = 0.3e-6;
  double corner_hz = 500e3;

  [[nodiscard]] double gain_at(double f) const { return gain / std::hypot(1.0, f / corner_hz); }
  [[nodiscard]] double lag_at(double f) const {
    return 2.0 * pi * f * delay_s + std::atan(f / corner_hz);
  }
};

std::vector<AdcCalibrationPoint> points_of(const TrueFrontEnd& adc, double vpp = 19.5) {
  std::vector<AdcCalibrationPoint> points;
  for (const double f :
       {1.0, 3.0, 10.0, 31.5, 100.0, 315.0, 1000.0, 3150.0, 10000.0, 31500.0, 100000.0}) {
    points.push_back({f, vpp, adc.gain_at(f), adc.lag_at(f), 1e-5, 3e-5});
  }
  return points;
}

TEST(AdcCalibration, InterpolatesADelayWithALowPassExactly) {
  const TrueFrontEnd adc;
  const auto points = points_of(adc);
  for (const double f : {1.0, 1.7, 10.0, 46.7, 80.0, 999.0, 5000.0, 62000.0, 100000.0}) {
    const auto response = adc_response_at(points, f);
    ASSERT_TRUE(response.has_value()) << f;
    EXPECT_NEAR(response->gain, adc.gain_at(f), 1e-12) << f;
    EXPECT_NEAR(response->phase_lag_rad, adc.lag_at(f), 1e-11) << f;
    EXPECT_LE(response->u_phase_lag_rad, 3.01e-5) << f;
    EXPECT_GE(response->u_phase_lag_rad, 2.1e-5) << f;
  }
}

TEST(AdcCalibration, GivesTheVeryPointAtACalibratedFrequency) {
  auto points = points_of({});
  points[4].phase_lag_rad += 1e-3; // a point that lies off
  const auto response = adc_response_at(points, 100.0);
  ASSERT_TRUE(response.has_value());
  EXPECT_NEAR(response->phase_lag_rad, points[4].phase_lag_rad, 1e-15);
  EXPECT_NEAR(response->gain, points[4].gain, 1e-15);
  EXPECT_NEAR(response->u_phase_lag_rad, 3e-5, 1e-18);
}

TEST(AdcCalibration, UncertaintyCoversWhatAStraightLineMisses) {
  std::vector<AdcCalibrationPoint> points;
  const auto lag = [](double f) { return 1e-3 * std::sin(f / 40.0); };
  for (double f = 10.0; f <= 200.0; f += 10.0) {
    points.push_back({f, 19.5, 1.0, lag(f), 0.0, 0.0});
  }
  for (double f = 15.0; f < 200.0; f += 10.0) {
    const auto response = adc_response_at(points, f);
    ASSERT_TRUE(response.has_value());
    EXPECT_LE(std::abs(response->phase_lag_rad - lag(f)), 2.0 * response->u_phase_lag_rad + 5e-7)
        << f;
  }
}

TEST(AdcCalibration, ExtrapolatesNothing) {
  const auto points = points_of({});
  for (const double f : {0.9, 100100.0, -1.0, std::nan("")}) {
    const auto response = adc_response_at(points, f);
    ASSERT_FALSE(response.has_value()) << f;
    EXPECT_EQ(response.error().code, ErrorCode::out_of_calibration);
  }
}

TEST(AdcCalibration, NeverMixesTestAmplitudes) {
  auto points = points_of({}, 19.5);
  const TrueFrontEnd small{.gain = 0.1712, .delay_s = 0.5e-6};
  for (const AdcCalibrationPoint& point : points_of(small, 1.95)) {
    points.push_back(point);
  }
  EXPECT_EQ(adc_response_at(points, 80.0).error().code, ErrorCode::invalid_argument);
  EXPECT_NEAR(adc_response_at(points, 80.0, 19.5)->gain, 0.16625, 1e-6);
  EXPECT_NEAR(adc_response_at(points, 80.0, 2.0)->phase_lag_rad, small.lag_at(80.0), 1e-11);
  EXPECT_EQ(adc_response_at(points, 80.0, 0.195).error().code, ErrorCode::out_of_calibration);
}

TEST(AdcCalibration, RefusesPointsThatCannotBe) {
  EXPECT_EQ(adc_response_at({}, 80.0).error().code, ErrorCode::invalid_argument);
  auto points = points_of({});
  points[3].gain = 0.0;
  EXPECT_EQ(adc_response_at(points, 80.0).error().code, ErrorCode::invalid_argument);
}

TEST(AdcCalibration, RepeatedMeasurementsGiveTheirMeanAndPooledScatter) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  const TrueFrontEnd adc;
  std::vector<AdcCalibrationPoint> measurements;
  for (int repetition = 0; repetition < 3; ++repetition) {
    for (AdcCalibrationPoint point : points_of(adc)) {
      point.gain *= 1.0 + 2e-5 * noise(random);
      point.phase_lag_rad += 6e-5 * noise(random);
      point.u_gain = point.u_phase_lag_rad = 0.0;
      measurements.push_back(point);
    }
  }
  const auto points = adc_calibration_points(measurements);
  ASSERT_EQ(points.size(), 11u);
  EXPECT_EQ(points[3].frequency_hz, 31.5);
  EXPECT_NEAR(points[3].phase_lag_rad,
              (measurements[3].phase_lag_rad + measurements[14].phase_lag_rad +
               measurements[25].phase_lag_rad) /
                  3.0,
              1e-15);
  EXPECT_NEAR(points[3].u_phase_lag_rad, 6e-5 / std::sqrt(3.0), 1.2e-5);
  EXPECT_NEAR(points[3].u_gain / points[3].gain, 2e-5 / std::sqrt(3.0), 5e-6);
}

// Lags about half a turn, each as it was measured: some positive, some negative.
TEST(AdcCalibration, AnInvertingFrontEndIsNoWorse) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise;
  const TrueFrontEnd adc;
  std::vector<AdcCalibrationPoint> upright, inverting;
  for (int repetition = 0; repetition < 3; ++repetition) {
    for (AdcCalibrationPoint point : points_of(adc)) {
      point.phase_lag_rad += 6e-5 * noise(random);
      upright.push_back(point);
      point.phase_lag_rad = std::remainder(point.phase_lag_rad + pi, 2.0 * pi);
      inverting.push_back(point);
    }
  }
  const auto both_signs =
      std::minmax_element(inverting.begin(), inverting.end(), [](const auto& a, const auto& b) {
        return a.phase_lag_rad < b.phase_lag_rad;
      });
  ASSERT_LT(both_signs.first->phase_lag_rad, -3.0);
  ASSERT_GT(both_signs.second->phase_lag_rad, 3.0);
  const auto straight = adc_calibration_points(upright);
  const auto turned = adc_calibration_points(inverting);
  for (const double f : {1.0, 1.7, 10.0, 46.7, 999.0, 62000.0}) {
    const auto is = adc_response_at(turned, f);
    const auto wanted = adc_response_at(straight, f);
    ASSERT_TRUE(is && wanted) << f;
    EXPECT_NEAR(std::remainder(is->phase_lag_rad - wanted->phase_lag_rad - pi, 2.0 * pi), 0.0, 2e-5)
        << f;
    EXPECT_NEAR(is->u_phase_lag_rad / wanted->u_phase_lag_rad, 1.0, 0.1) << f;
  }
}

TEST(AdcCalibration, WhatRepetitionsHaveInCommonIsAddedToTheirScatter) {
  std::vector<AdcCalibrationPoint> measurements;
  for (const double lag : {1e-3 - 3e-5, 1e-3 + 3e-5}) {
    measurements.push_back({100.0, 19.5, 0.166, lag, 1e-4, 4e-5});
  }
  const auto points = adc_calibration_points(measurements);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].u_phase_lag_rad, std::hypot(4e-5, 3e-5),
              1e-12); // scatter sqrt(2) 3e-5 over sqrt(2) repetitions
  EXPECT_NEAR(points[0].u_gain, 1e-4, 1e-15);
}

TEST(AdcCalibration, WhatTwoPointsHaveInCommonDoesNotAverageOutBetweenThem) {
  const std::vector<AdcCalibrationPoint> points{{100.0, 19.5, 1.0, 1e-3, 0.0, 5e-5},
                                                {200.0, 19.5, 1.0, 2e-3, 0.0, 5e-5}};
  EXPECT_NEAR(adc_response_at(points, 150.0)->u_phase_lag_rad, 5e-5, 1e-12);
}

TEST(AdcCalibration, SingleMeasurementsTakeTheirScatterFromTheirNeighbours) {
  std::mt19937 random(8);
  std::normal_distribution<double> noise;
  const TrueFrontEnd adc;
  std::vector<AdcCalibrationPoint> measurements;
  for (double f = 100.0; f < 11000.0; f *= 1.02) {
    measurements.push_back({f, 19.5, adc.gain_at(f), adc.lag_at(f) + 5e-5 * noise(random), 0, 0});
  }
  const auto points = adc_calibration_points(measurements);
  ASSERT_EQ(points.size(), measurements.size());
  double mean = 0.0;
  for (const AdcCalibrationPoint& point : points) {
    mean += point.u_phase_lag_rad / static_cast<double>(points.size());
  }
  EXPECT_NEAR(mean, 5e-5, 1.5e-5);
}

} // namespace
} // namespace dyncal::analysis
