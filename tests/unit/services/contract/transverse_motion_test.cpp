#include "services/contract/transverse_motion.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

TEST(TransverseMotion, HoldsBetweenItsFrequenciesAndNotBeyond) {
  const std::vector<TransverseMotionPoint> points{{100.0, 0.05}, {10.0, 0.01}, {50.0, 0.02}};
  EXPECT_EQ(ratio_at(points, 10.0), 0.01);
  EXPECT_EQ(ratio_at(points, 20.0), 0.02); // the larger one of its neighbours
  EXPECT_EQ(ratio_at(points, 50.0), 0.02);
  EXPECT_EQ(ratio_at(points, 60.0), 0.05);
  EXPECT_EQ(ratio_at(points, 9.0), std::nullopt);
  EXPECT_EQ(ratio_at(points, 101.0), std::nullopt);
  EXPECT_EQ(ratio_at({}, 80.0), std::nullopt);
  const std::vector<TransverseMotionPoint> everywhere{{0.0, 0.03}};
  EXPECT_EQ(ratio_at(everywhere, 5000.0), 0.03);
}

} // namespace
} // namespace dyncal::inline contract
