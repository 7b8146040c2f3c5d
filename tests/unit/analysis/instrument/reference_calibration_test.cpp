#include "analysis/instrument/reference_calibration.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

using testing::HasSubstr;

ReferenceCalibrationPoint point(double frequency_hz, double level_m_s2, double magnitude,
                                double phase_rad) {
  return {frequency_hz,
          level_m_s2,
          magnitude,
          phase_rad,
          {{.name = "distortion", .u_magnitude_rel = 1e-4 * frequency_hz, .u_phase_rad = 2e-4},
           {.name = "", .u_magnitude_rel = 1e-3, .u_phase_rad = 1e-3, .degrees_of_freedom = 12.0}}};
}

TEST(ReferenceCalibration, GivesAPointAsItIs) {
  const std::vector points{point(20.0, 0.0, 1.01, -0.02), point(10.0, 0.0, 1.0, -0.01)};
  const auto response = reference_response_at(points, 20.0, 50.0);
  ASSERT_TRUE(response) << response.error().message;
  EXPECT_EQ(response->magnitude, 1.01);
  EXPECT_EQ(response->phase_rad, -0.02);
  ASSERT_EQ(response->contributions.size(), 3U);
  EXPECT_EQ(response->contributions[0].name, "distortion");
  EXPECT_DOUBLE_EQ(response->contributions[0].u_magnitude_rel, 2e-3);
  EXPECT_EQ(response->contributions[1].degrees_of_freedom, 12.0);
  EXPECT_EQ(response->contributions[2].u_magnitude_rel, 0.0); // nothing is interpolated
}

TEST(ReferenceCalibration, InterpolatesOverFrequencyAndThenOverLevel) {
  const std::vector points{point(10.0, 10.0, 1.00, -0.01), point(20.0, 10.0, 1.02, -0.02),
                           point(10.0, 50.0, 1.04, -0.05), point(20.0, 50.0, 1.06, -0.06)};
  const auto response = reference_response_at(points, 15.0, 30.0);
  ASSERT_TRUE(response) << response.error().message;
  EXPECT_NEAR(response->magnitude, 1.03, 1e-12);
  EXPECT_NEAR(response->phase_rad, -0.035, 1e-12);
  EXPECT_NEAR(response->contributions[0].u_magnitude_rel, 1.5e-3, 1e-12);
  EXPECT_EQ(response->contributions[1].degrees_of_freedom, 12.0);
}

TEST(ReferenceCalibration, ACurvedResponseLiesWithinWhatTheInterpolationAdds) {
  std::vector<ReferenceCalibrationPoint> points;
  const auto truth = [](double hz) { return 1.0 + std::pow(hz / 1000.0, 2); };
  for (const double hz : {100.0, 200.0, 300.0, 400.0}) {
    points.push_back(point(hz, 0.0, truth(hz), 0.0));
  }
  const auto response = reference_response_at(points, 250.0, 0.0);
  ASSERT_TRUE(response) << response.error().message;
  const double missed = std::abs(response->magnitude - truth(250.0)) / response->magnitude;
  EXPECT_GT(missed, 1e-3);
  EXPECT_EQ(response->contributions.back().name, "interpolation");
  EXPECT_NEAR(response->contributions.back().u_magnitude_rel, missed / std::sqrt(3.0), 1e-9);
}

// The certificate of an inverting charge amplifier: 179.9 and -179.8 degrees.
TEST(ReferenceCalibration, PhasesAboutHalfATurnAreNotTakenThroughZero) {
  constexpr double degree = std::numbers::pi / 180.0;
  const std::vector points{point(40.0, 0.0, 1.0, 179.9 * degree),
                           point(80.0, 0.0, 1.0, -179.8 * degree),
                           point(160.0, 0.0, 1.0, 179.7 * degree)};
  for (const double hz : {57.0, 113.0}) {
    const auto response = reference_response_at(points, hz, 0.0);
    ASSERT_TRUE(response) << response.error().message;
    EXPECT_NEAR(std::abs(std::remainder(response->phase_rad, 360.0 * degree)), 180.0 * degree,
                0.5 * degree);
    EXPECT_LE(std::abs(response->phase_rad), std::numbers::pi);
    EXPECT_LT(response->contributions.back().u_phase_rad, 0.5 * degree);
  }
  const std::vector levels{point(40.0, 1.0, 1.0, 179.9 * degree),
                           point(40.0, 5.0, 1.0, -179.9 * degree)};
  const auto between = reference_response_at(levels, 40.0, 3.0);
  ASSERT_TRUE(between) << between.error().message;
  EXPECT_NEAR(std::abs(between->phase_rad), 180.0 * degree, 1e-9);
}

TEST(ReferenceCalibration, ExtrapolatesNothing) {
  const std::vector points{point(10.0, 10.0, 1.0, 0.0), point(20.0, 10.0, 1.0, 0.0),
                           point(10.0, 50.0, 1.0, 0.0), point(20.0, 50.0, 1.0, 0.0)};
  for (const double hz : {9.9, 20.1}) {
    const auto response = reference_response_at(points, hz, 30.0);
    ASSERT_FALSE(response);
    EXPECT_EQ(response.error().code, ErrorCode::out_of_calibration);
    EXPECT_THAT(response.error().message, HasSubstr("from 10 to 20 Hz"));
  }
  for (const double level : {9.9, 50.1}) {
    const auto response = reference_response_at(points, 15.0, level);
    ASSERT_FALSE(response);
    EXPECT_EQ(response.error().code, ErrorCode::out_of_calibration);
    EXPECT_THAT(response.error().message, HasSubstr("from 10 to 50 m/s^2"));
  }
  EXPECT_TRUE(reference_response_at(points, 10.0, 50.0));
}

TEST(ReferenceCalibration, RefusesPointsThatContradictEachOther) {
  const auto problem = [](const std::vector<ReferenceCalibrationPoint>& points) {
    const auto response = reference_response_at(points, 10.0, 0.0);
    return response ? std::string() : response.error().message;
  };
  EXPECT_THAT(problem({}), HasSubstr("no points"));
  EXPECT_THAT(problem({point(10.0, 0.0, 1.0, 0.0), point(10.0, 0.0, 1.1, 0.0)}),
              HasSubstr("10 Hz twice"));
  EXPECT_THAT(problem({point(10.0, 0.0, -1.0, 0.0)}), HasSubstr("not valid"));
  EXPECT_THAT(problem({point(10.0, 0.0, 1.0, 0.0), {20.0, 0.0, 1.0, 0.0, {}}}),
              HasSubstr("contributions are not those"));
}

} // namespace
} // namespace dyncal::analysis
