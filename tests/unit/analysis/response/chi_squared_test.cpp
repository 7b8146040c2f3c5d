#include "analysis/response/chi_squared.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(ChiSquared, IsAnExponentialForTwoDegreesOfFreedom) {
  for (const double x : {1e-3, 0.7, 2.0, 9.0, 100.0, 1300.0}) {
    EXPECT_NEAR(chi_squared_probability(x, 2.0) / std::exp(-0.5 * x), 1.0, 1e-11) << x;
  }
}

TEST(ChiSquared, IsTheComplementOfTheErrorFunctionForOne) {
  for (const double x : {1e-3, 0.5, 3.841458820694124, 25.0, 400.0}) {
    EXPECT_NEAR(chi_squared_probability(x, 1.0) / std::erfc(std::sqrt(0.5 * x)), 1.0, 1e-11) << x;
  }
}

// Q(x, nu + 2) = Q(x, nu) + (x / 2)^(nu / 2) e^(-x / 2) / Gamma(nu / 2 + 1)
TEST(ChiSquared, FollowsTheRecurrenceOverDegreesOfFreedom) {
  for (const double x : {0.1, 5.0, 31.0, 90.0}) {
    double sum = std::exp(-0.5 * x);
    for (double nu = 2.0; nu < 80.0; nu += 2.0) {
      EXPECT_NEAR(chi_squared_probability(x, nu) / sum, 1.0, 1e-11) << x << ' ' << nu;
      sum += std::exp(0.5 * nu * std::log(0.5 * x) - 0.5 * x - std::lgamma(0.5 * nu + 1.0));
    }
  }
}

TEST(ChiSquared, IsCertainWithoutASumOrDegreesOfFreedom) {
  EXPECT_EQ(chi_squared_probability(0.0, 3.0), 1.0);
  EXPECT_EQ(chi_squared_probability(-1.0, 3.0), 1.0);
  EXPECT_EQ(chi_squared_probability(3.0, 0.0), 1.0);
}

} // namespace
} // namespace dyncal::analysis
