#include "analysis/response/triaxial.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

const std::array<Axes, 3> truth{
    Axes{std::polar(0.99, -0.8), std::polar(0.02, 1.0), std::polar(0.01, 2.0)},
    Axes{std::polar(0.015, -2.0), std::polar(1.01, -0.81), std::polar(0.02, 0.3)},
    Axes{std::polar(0.01, 0.5), std::polar(0.012, 3.0), std::polar(0.95, -0.79)}};

Axes answer_to(const Axes& motion) {
  Axes result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      result[i] += truth[i][j] * motion[j];
    }
  }
  return result;
}

// Each excitation moves mostly along one axis, the others a little and out of phase.
std::vector<TriaxialExcitation> excitations(double u, unsigned seed, std::size_t count = 3) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, u > 0.0 ? u : 1.0);
  std::vector<TriaxialExcitation> result(count);
  for (std::size_t k = 0; k < count; ++k) {
    Axes motion{std::polar(0.1, 0.3), std::polar(0.05, -1.0), std::polar(0.08, 2.0)};
    motion[k % 3] = std::polar(10.0, 0.4 * static_cast<double>(k));
    result[k].reference = motion;
    result[k].sensor = answer_to(motion);
    for (std::size_t i = 0; i < 3; ++i) {
      if (u > 0.0) {
        result[k].reference[i] += std::complex<double>(noise(random), noise(random));
        result[k].sensor[i] += std::complex<double>(noise(random), noise(random));
      }
      result[k].u_reference[i] = result[k].u_sensor[i] = u;
    }
  }
  return result;
}

TEST(Triaxial, FindsTheWholeMatrixThroughMotionAcrossTheAxes) {
  for (const std::size_t count : {3u, 6u}) {
    const auto result = evaluate_triaxial(excitations(0.0, 1, count));
    ASSERT_TRUE(result.has_value());
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_LT(std::abs(result->h[i][j] - truth[i][j]), 1e-14);
      }
    }
  }
}

TEST(Triaxial, UncertaintyCoversTheScatter) {
  int covered = 0;
  constexpr int runs = 300;
  for (unsigned run = 1; run <= runs; ++run) {
    const auto result = evaluate_triaxial(excitations(1e-3, run));
    ASSERT_TRUE(result.has_value());
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        covered += std::abs(result->h[i][j].real() - truth[i][j].real()) <= 2.0 * result->u[i][j];
      }
    }
  }
  EXPECT_NEAR(covered / (9.0 * runs), 0.9545, 0.015);
}

TEST(Triaxial, RefusesMotionsInAPlane) {
  auto flat = excitations(0.0, 1);
  flat[2].reference = flat[0].reference;
  EXPECT_EQ(evaluate_triaxial(flat).error().code, ErrorCode::ill_conditioned);
  flat.pop_back();
  EXPECT_EQ(evaluate_triaxial(flat).error().code, ErrorCode::too_few_samples);
}

TEST(Triaxial, ASingleAxisReferenceBoundsWhatItDoesNotSee) {
  const Axes column{std::polar(0.02, 1.0), std::polar(0.01, 2.0), std::polar(0.95, -0.8)};
  const auto result = transverse_sensitivity(column, {1e-4, 1e-4, 1e-4}, 2, {1.0, 1.0, 1.0}, 0.01);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->ratio[0], 0.02 / 0.95, 1e-15);
  EXPECT_NEAR(result->largest, 0.02 / 0.95, 1e-15);
  EXPECT_EQ(result->ratio[2], 1.0);
  EXPECT_NEAR(result->u_ratio[0], 0.01 / std::sqrt(3.0) / 0.95, 1e-4);
  EXPECT_FALSE(transverse_sensitivity(column, {}, 3, {}, 0.0).has_value());
  EXPECT_FALSE(transverse_sensitivity({}, {}, 0, {}, 0.0).has_value());
}

} // namespace
} // namespace dyncal::analysis
