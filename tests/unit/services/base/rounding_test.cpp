#include "services/base/rounding.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::inline base {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const double not_a_number = std::nan("");

void expect_rounded(double value, double u, const std::string& value_text,
                    const std::string& u_text) {
  const RoundedValue rounded = round_by_uncertainty(value, u);
  EXPECT_EQ(rounded.value, value_text) << value << " u " << u;
  EXPECT_EQ(rounded.u, u_text) << value << " u " << u;
}

TEST(Rounding, TheValueEndsWhereItsUncertaintyDoes) {
  expect_rounded(0.9771834, 0.000934, "0.97718", "0.00093");
  expect_rounded(-3.141592, 0.00087, "-3.14159", "0.00087");
  expect_rounded(8.1, 0.001, "8.1000", "0.0010");
  expect_rounded(1003.04927, 0.017, "1003.049", "0.017");
  expect_rounded(12.0, 3.4, "12.0", "3.4");
  expect_rounded(1234.5, 34.0, "1234", "34");
}

TEST(Rounding, UncertaintiesAboveAHundredRoundBeforeThePoint) {
  expect_rounded(9814.26, 230.0, "9810", "230");
  expect_rounded(9815.26, 1234.0, "9800", "1200");
}

TEST(Rounding, ACarryKeepsTwoDigits) {
  expect_rounded(1.0, 0.0996, "1.00", "0.10");
  expect_rounded(0.9996, 0.0099996, "1.000", "0.010");
  expect_rounded(9.99996e-6, 1e-9, "1.00000e-05", "1.0e-09");
  expect_rounded(-9.96e-6, 1.2e-6, "-1.00e-05", "1.2e-06");
}

TEST(Rounding, SmallAndLargeNumbersHaveAnExponent) {
  expect_rounded(1.0168e-8, 1.3e-11, "1.0168e-08", "1.3e-11");
  expect_rounded(8.1234e-6, 1.5e-8, "8.123e-06", "1.5e-08");
  expect_rounded(2.34567e9, 1.2e6, "2.3457e+09", "1.2e+06");
}

TEST(Rounding, AValueBelowItsUncertaintyIsNotLost) {
  expect_rounded(2e-7, 0.014, "0.000", "0.014");
  expect_rounded(-2e-7, 0.014, "0.000", "0.014"); // not -0.000
  expect_rounded(8e-6, 1.5e-5, "8e-06", "1.5e-05");
  expect_rounded(1e-13, 1.5e-5, "0", "1.5e-05");
  expect_rounded(0.0, 1.5e-5, "0", "1.5e-05");
  expect_rounded(0.0, 0.5, "0.00", "0.50");
}

TEST(Rounding, AVerySmallUncertaintyShowsAllDigitsThereAre) {
  expect_rounded(1.0168, 2.1e-12, "1.0168000000000", "2.1e-12");
}

TEST(Rounding, WithoutAnUncertaintyThereAreSixDigits) {
  expect_rounded(0.97718345, 0.0, "0.977183", "0");
  expect_rounded(0.97718345, not_a_number, "0.977183", "nan");
  expect_rounded(0.97718345, infinity, "0.977183", "inf");
  expect_rounded(0.97718345, -1.0, "0.977183", "-1");
}

TEST(Rounding, WhatIsNoNumberStaysVisible) {
  expect_rounded(not_a_number, 0.1, "nan", "0.10");
  expect_rounded(infinity, 0.1, "inf", "0.10");
  expect_rounded(-infinity, not_a_number, "-inf", "nan");
}

TEST(Rounding, UncertaintiesAloneHaveTwoDigits) {
  EXPECT_EQ(rounded_uncertainty(0.00934), "0.0093");
  EXPECT_EQ(rounded_uncertainty(0.0000934), "9.3e-05");
  EXPECT_EQ(rounded_uncertainty(151.0), "150");
  EXPECT_EQ(rounded_uncertainty(0.0), "0");
}

TEST(Rounding, PhasesHaveOneSignInBothUnits) {
  constexpr double pi = std::numbers::pi;
  const RoundedPhase end = round_phase(-pi + 4e-6, 3.5e-4);
  EXPECT_EQ(end.degrees.value, "180.000");
  EXPECT_EQ(end.radians.value, "3.14160");
  EXPECT_EQ(round_phase(-pi, 0.2).degrees.value, "180");
  EXPECT_EQ(round_phase(-pi, 0.2).radians.value, "3.14");
  // One place beside the end: as it is.
  const RoundedPhase beside = round_phase(-pi + 2e-5, 3.5e-4);
  EXPECT_EQ(beside.degrees.value, "-179.999");
  EXPECT_EQ(beside.radians.value, "-3.14157");
  EXPECT_EQ(round_phase(pi, 3.5e-4).radians.value, "3.14159");
  EXPECT_EQ(round_phase(-0.5, 0.0).radians.value, "-0.5");
}

// Whatever the sizes: reading the text back gives the value within half a unit of its last place.
TEST(Rounding, NothingMovesByMoreThanHalfAPlace) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-14.0, 14.0);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::pow(10.0, exponent(random)) * (i % 2 == 0 ? 1.0 : -1.0);
    const double u = std::pow(10.0, exponent(random));
    const RoundedValue rounded = round_by_uncertainty(value, u);
    // Two digits of u: a place is at most a tenth of u, and a double has 16 digits.
    EXPECT_NEAR(std::stod(rounded.value), value, 0.0501 * u + 1e-15 * std::abs(value))
        << rounded.value;
    EXPECT_NEAR(std::stod(rounded.u), u, 0.0501 * u) << rounded.u;
  }
}

} // namespace
} // namespace dyncal::inline base
