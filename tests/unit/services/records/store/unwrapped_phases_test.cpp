#include "services/records/store/unwrapped_phases.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline records {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;
constexpr double delay_s = 1.7e-3; // 0.68 of a turn at 400 Hz

// Of a delay, and of `offset_rad` besides, within (-pi, pi].
Calibration calibration(double offset_rad) {
  Calibration one;
  for (const double frequency_hz : {10.0, 40.0, 80.0, 160.0, 200.0, 250.0, 315.0, 400.0}) {
    for (const double level_m_s2 : {2.0, 10.0}) {
      StoredValue point;
      point.channel = "dau/z";
      point.frequency_hz = frequency_hz;
      point.level_m_s2 = level_m_s2;
      point.phase_rad = std::remainder(offset_rad - turn * frequency_hz * delay_s, turn);
      point.unwrapped_phase_rad = nan("");
      one.points.push_back(point);
    }
  }
  return one;
}

TEST(UnwrappedPhases, FollowADelay) {
  std::vector<Calibration> calibrations{calibration(0.0)};
  unwrap_phases(calibrations);
  ASSERT_EQ(calibrations[0].points.size(), 16U);
  for (const StoredValue& point : calibrations[0].points) {
    EXPECT_NEAR(point.unwrapped_phase_rad, -turn * point.frequency_hz * delay_s, 1e-12);
  }
}

// Two that lie on either side of half a turn are as near to each other as they are.
TEST(UnwrappedPhases, OfLaterCalibrationsAreNearTheFirst) {
  std::vector<Calibration> calibrations{calibration(std::numbers::pi + 0.15),
                                        calibration(std::numbers::pi + 0.05)};
  unwrap_phases(calibrations);
  for (std::size_t i = 0; i < calibrations[0].points.size(); ++i) {
    EXPECT_NEAR(calibrations[0].points[i].unwrapped_phase_rad -
                    calibrations[1].points[i].unwrapped_phase_rad,
                0.1, 1e-12);
  }
}

TEST(UnwrappedPhases, AreNotKnownWherePhasesAreNot) {
  std::vector<Calibration> calibrations{calibration(0.0)};
  calibrations[0].points[2].phase_rad = nan("");
  unwrap_phases(calibrations);
  EXPECT_TRUE(std::isnan(calibrations[0].points[2].unwrapped_phase_rad));
  EXPECT_FALSE(std::isnan(calibrations[0].points[3].unwrapped_phase_rad));
}

} // namespace
} // namespace dyncal::inline records
