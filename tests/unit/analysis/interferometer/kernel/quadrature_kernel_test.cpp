#include "analysis/interferometer/kernel/quadrature_kernel.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis::kernel {
namespace {

constexpr QuadratureCorrection correction{12.5, -3.25, 0.087, 1.054};

template <class Number>
std::vector<Number> drawn(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(-7000.0, 7000.0);
  std::vector<Number> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(static_cast<Number>(value(random)));
  }
  return values;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), 8 * a.size()) == 0;
}

std::size_t supported_count() {
  std::size_t count = 0;
  while (supported_quadrature_kernels()[count] != nullptr) {
    ++count;
  }
  return count;
}

template <class Number>
void expect_same_phases(QuadraturePhase<Number> QuadratureKernel::*function) {
  for (std::size_t n = 1; n < 80; ++n) {
    const auto u1 = drawn<Number>(n, static_cast<unsigned>(n));
    const auto u2 = drawn<Number>(n, static_cast<unsigned>(n + 1000));
    std::vector<double> first[2] = {std::vector<double>(n), std::vector<double>(n)};
    (baseline_quadrature_kernel.*function)(u1.data(), u2.data(), n, correction, first[0].data(),
                                           first[1].data());
    for (std::size_t k = 1; k < supported_count(); ++k) {
      const QuadratureKernel& other = *supported_quadrature_kernels()[k];
      std::vector<double> turns(n);
      std::vector<double> radius(n);
      (other.*function)(u1.data(), u2.data(), n, correction, turns.data(), radius.data());
      EXPECT_TRUE(same_bits(turns, first[0])) << other.name << " " << n;
      EXPECT_TRUE(same_bits(radius, first[1])) << other.name << " " << n;
    }
  }
}

TEST(QuadratureKernel, GivesTheSamePhasesOnEveryInstructionSet) {
  expect_same_phases<std::int16_t>(&QuadratureKernel::phase_of_int16);
  expect_same_phases<float>(&QuadratureKernel::phase_of_float);
  expect_same_phases<double>(&QuadratureKernel::phase_of_double);
}

TEST(QuadratureKernel, GivesTheSameSumsOnEveryInstructionSet) {
  const auto x = drawn<double>(1004, 1);
  const auto y = drawn<double>(1004, 2);
  std::vector<double> first(quadrature_moments);
  baseline_quadrature_kernel.moments(x.data(), y.data(), 1000, first.data());
  ASSERT_GT(first[2], 0.0);
  for (std::size_t k = 1; k < supported_count(); ++k) {
    const QuadratureKernel& other = *supported_quadrature_kernels()[k];
    std::vector<double> sums(quadrature_moments);
    other.moments(x.data(), y.data(), 1000, sums.data());
    EXPECT_TRUE(same_bits(sums, first)) << other.name;
    EXPECT_EQ(other.fourth_difference_squares(x.data(), 1000),
              baseline_quadrature_kernel.fourth_difference_squares(x.data(), 1000));
    for (std::size_t n = 0; n < 60; ++n) {
      EXPECT_EQ(other.sum_of_products(x.data(), y.data(), n),
                baseline_quadrature_kernel.sum_of_products(x.data(), y.data(), n));
    }
  }
}

TEST(QuadratureKernel, SumsAreThoseOfTheirDefinition) {
  const std::vector<double> x = {1.0, 2.0, 3.0, -1.0, 0.5, 0.0, 4.0, 7.0, 9.0, -2.0, 3.0, 1.0};
  const std::vector<double> y = {2.0, 1.0, -1.0, 0.0, 3.0, 1.0, 5.0, 2.0, 1.0, 1.0, 1.0, 1.0};
  std::vector<double> sums(quadrature_moments);
  baseline_quadrature_kernel.moments(x.data(), y.data(), 8, sums.data());
  double expected[3] = {};
  double differences = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    expected[0] += x[i];
    expected[1] += x[i] * x[i] * y[i];
    expected[2] += x[i] * y[i] * y[i] * y[i];
    const double difference = x[i] - 4 * x[i + 1] + 6 * x[i + 2] - 4 * x[i + 3] + x[i + 4];
    differences += difference * difference;
  }
  EXPECT_DOUBLE_EQ(sums[0], expected[0]);
  EXPECT_DOUBLE_EQ(sums[6], expected[1]);
  EXPECT_DOUBLE_EQ(sums[12], expected[2]);
  EXPECT_DOUBLE_EQ(baseline_quadrature_kernel.fourth_difference_squares(x.data(), 8), differences);
}

TEST(QuadratureKernel, PhaseIsTheArctangent) {
  constexpr std::size_t n = 20000;
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) / n - 0.5);
    x.push_back(3.0 * std::cos(angle));
    y.push_back(3.0 * std::sin(angle));
  }
  for (const auto& [a, b] : {std::pair{0.0, 1.0},
                             {0.0, -1.0},
                             {-1.0, 0.0},
                             {1.0, 0.0},
                             {0.0, 0.0},
                             {-2.0, -2.0},
                             {1e-200, 1e-200},
                             {1.0, std::sqrt(2.0) - 1.0}}) {
    x.push_back(a);
    y.push_back(b);
  }
  std::vector<double> turns(x.size());
  std::vector<double> radius(x.size());
  best_quadrature_kernel().phase_of_double(x.data(), y.data(), x.size(), {0.0, 0.0, 0.0, 1.0},
                                           turns.data(), radius.data());
  double worst = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto exact = std::atan2(static_cast<long double>(y[i]), static_cast<long double>(x[i])) /
                       (2.0L * std::numbers::pi_v<long double>);
    worst = std::max(worst, static_cast<double>(std::fabs(exact - turns[i])));
  }
  EXPECT_LT(worst, 2e-16);
  EXPECT_GT(worst, 0.0);
}

TEST(QuadratureKernel, WhatIsNotFiniteHasNoFiniteRadius) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double x[2] = {infinity, std::nan("")};
  const double y[2] = {1.0, 1.0};
  double turns[2];
  double radius[2];
  best_quadrature_kernel().phase_of_double(x, y, 2, correction, turns, radius);
  EXPECT_FALSE(std::isfinite(radius[0]));
  EXPECT_FALSE(std::isfinite(radius[1]));
}

} // namespace
} // namespace dyncal::analysis::kernel
