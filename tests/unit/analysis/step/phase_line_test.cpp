#include "analysis/step/phase_line.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(PhaseLine, GoesThroughWhatIsStraight) {
  const std::vector<FramePhase> frames{{0.0, 1.0, 0.1}, {1.0, 1.5, 0.1}, {3.0, 2.5, 0.1}};
  const PhaseLine line = fit_phase_line(frames);
  EXPECT_DOUBLE_EQ(line.slope_rad, 0.5);
  EXPECT_DOUBLE_EQ(line.x_mean, 4.0 / 3.0);
  EXPECT_DOUBLE_EQ(line.mean_rad, 5.0 / 3.0);
  EXPECT_NEAR(line.u_mean_rad, 0.1 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(line.u_slope_rad, 0.1 / std::sqrt(14.0 / 3.0), 1e-12);
}

TEST(PhaseLine, TakesItsUncertaintyFromTheScatterWhereThatIsLarger) {
  const std::vector<FramePhase> frames{
      {0.0, 1.0, 1e-3}, {1.0, -1.0, 1e-3}, {2.0, 1.0, 1e-3}, {3.0, -1.0, 1e-3}};
  const PhaseLine line = fit_phase_line(frames);
  EXPECT_DOUBLE_EQ(line.slope_rad, -0.4);
  EXPECT_NEAR(line.u_mean_rad, std::sqrt(3.2 / 2.0 / 4.0), 1e-12);
}

TEST(PhaseLine, OfTwoFramesHasTheirUncertainty) {
  const std::vector<FramePhase> frames{{5.0, 0.0, 0.03}, {6.0, 0.2, 0.04}};
  const PhaseLine line = fit_phase_line(frames);
  EXPECT_DOUBLE_EQ(line.slope_rad, 0.2);
  EXPECT_NEAR(line.u_mean_rad, 0.025, 1e-12);
}

} // namespace
} // namespace dyncal::analysis
