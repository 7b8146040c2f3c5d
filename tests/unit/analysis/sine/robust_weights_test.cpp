#include "analysis/sine/robust_weights.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(RobustWeights, FollowTheirDefinitions) {
  EXPECT_EQ(robust_weight(Weighting::none, 1e6, 1.0), 1.0);
  EXPECT_EQ(robust_weight(Weighting::huber, 1.3, 1.0), 1.0);
  EXPECT_NEAR(robust_weight(Weighting::huber, -2.69, 1.0), 0.5, 1e-15);
  EXPECT_NEAR(robust_weight(Weighting::huber, 26.9, 10.0), 0.5, 1e-15); // in units of the scale
  EXPECT_EQ(robust_weight(Weighting::tukey, 0.0, 1.0), 1.0);
  EXPECT_NEAR(robust_weight(Weighting::tukey, 4.685 / 2.0, 1.0), 0.5625, 1e-15);
  EXPECT_EQ(robust_weight(Weighting::tukey, 4.7, 1.0), 0.0);
}

TEST(RobustWeights, TheSlopeIsTheDerivativeOfPsi) {
  constexpr double h = 1e-6;
  for (const Weighting weighting : {Weighting::none, Weighting::huber, Weighting::tukey}) {
    for (const double r : {0.0, 0.7, -1.1, 2.0, 4.0, 6.0}) {
      const auto psi = [&](double x) { return x * robust_weight(weighting, x, 1.0); };
      EXPECT_NEAR(robust_slope(weighting, r, 1.0), (psi(r + h) - psi(r - h)) / (2.0 * h), 1e-6)
          << r;
    }
  }
}

TEST(RobustWeights, TheScaleIsThatOfTheGoodResiduals) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 2.0);
  std::vector<double> residuals;
  for (int i = 0; i < 20'000; ++i) {
    residuals.push_back(i % 10 == 0 ? 1e6 : std::abs(normal(random)));
  }
  const double scale = robust_scale(residuals);
  EXPECT_GT(scale, 2.0); // a tenth of outliers lengthens it by some 20 %
  EXPECT_LT(scale, 2.5);
}

} // namespace
} // namespace dyncal::analysis
