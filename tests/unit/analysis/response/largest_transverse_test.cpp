#include "analysis/response/largest_transverse.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double pi = 3.14159265358979323846;

TEST(LargestTransverse, IsThatOfOneDirection) {
  const double angle = 37.0 * pi / 180.0;
  const std::complex<double> largest = std::polar(0.02, 1.3);
  const LargestTransverse found =
      largest_transverse({largest * std::cos(angle), 1e-4}, {largest * std::sin(angle), 1e-4}, 0.8);
  EXPECT_NEAR(found.ratio, 0.025, 1e-15);
  EXPECT_NEAR(found.angle_rad, angle, 1e-12);
  EXPECT_NEAR(found.u_ratio, 1e-4 / 0.8, 1e-15);
  // behind the first axis
  EXPECT_NEAR(largest_transverse({{1.0, 0.0}, 0.0}, {{-1.0, 0.0}, 0.0}, 1.0).angle_rad, 0.75 * pi,
              1e-12);
}

// No direction has a larger one, whatever the phases are.
TEST(LargestTransverse, IsTheLargestOfAllDirections) {
  std::mt19937 generator(17);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const std::complex<double> a(normal(generator), normal(generator));
    const std::complex<double> b(normal(generator), normal(generator));
    const LargestTransverse found = largest_transverse({a, 0.0}, {b, 0.0}, 1.0);
    double largest = 0.0;
    for (double t = 0.0; t < pi; t += 1e-3) {
      largest = std::max(largest, std::abs(a * std::cos(t) + b * std::sin(t)));
    }
    EXPECT_NEAR(found.ratio, largest, 1e-6 * largest);
    EXPECT_NEAR(std::abs(a * std::cos(found.angle_rad) + b * std::sin(found.angle_rad)),
                found.ratio, 1e-12);
  }
}

} // namespace
} // namespace dyncal::analysis
