#include "services/views/report/stated_value.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

StoredValue value_of(double magnitude, double expanded, double phase_rad, double expanded_rad) {
  StoredValue value;
  value.frequency_text_hz = "10";
  value.frequency_hz = 10.0;
  value.magnitude = magnitude;
  value.of_magnitude = {.u = expanded / 2.0, .k = 2.0, .expanded = expanded};
  value.phase_rad = phase_rad;
  value.of_phase = {.u = expanded_rad / 2.03, .k = 2.03, .expanded = expanded_rad};
  value.coverage_probability = 0.9544997361036416;
  return value;
}

TEST(StatedValue, HasTheDigitsOfItsExpandedUncertainty) {
  const StoredValue value = value_of(0.977183462, 0.0018749, -0.52359877, 0.01249);
  const StatedValue magnitude = stated_magnitude(value);
  EXPECT_EQ(magnitude.value, "0.9772");
  EXPECT_EQ(magnitude.expanded, "0.0019");
  EXPECT_EQ(magnitude.k, "2.00");
  const StatedValue radians = stated_phase_rad(value);
  EXPECT_EQ(radians.value, "-0.524");
  EXPECT_EQ(radians.expanded, "0.012");
  EXPECT_EQ(radians.k, "2.03");
  const StatedValue degrees = stated_phase_deg(value);
  EXPECT_EQ(degrees.value, "-30.00");
  EXPECT_EQ(degrees.expanded, "0.72");
}

TEST(StatedValue, StaysWithinItsTurnNear180Degrees) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    int at_the_end = 0;
    for (int draw = 0; draw < 300; ++draw) {
      const double phase_rad =
          std::remainder(std::numbers::pi + 1e-3 * normal(random), 2.0 * std::numbers::pi);
      const StatedValue degrees = stated_phase_deg(value_of(1.0, 0.1, phase_rad, 1e-3));
      const double stated = std::stod(degrees.value);
      EXPECT_GT(stated, -180.0) << phase_rad;
      EXPECT_LE(stated, 180.0) << phase_rad;
      const double phase_deg = 180.0 / std::numbers::pi * phase_rad;
      EXPECT_LE(std::abs(std::remainder(stated - phase_deg, 360.0)), 0.0005 + 1e-9) << phase_rad;
      at_the_end += degrees.value == "180.000" ? 1 : 0;
      const StatedValue radians = stated_phase_rad(value_of(1.0, 0.1, phase_rad, 1e-3));
      EXPECT_EQ(radians.value.front() == '-', degrees.value.front() == '-') << phase_rad;
      EXPECT_LE(
          std::abs(std::remainder(std::stod(radians.value) - phase_rad, 2.0 * std::numbers::pi)),
          0.00005 + 1e-9)
          << phase_rad;
    }
    EXPECT_GT(at_the_end, 0);
  }
}

TEST(StatedValue, CannotBeStatedWithoutAUsableUncertainty) {
  EXPECT_TRUE(can_be_stated(value_of(1.0, 0.1, 1.0, 0.1)));
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, 0.0, -1.0}) {
    EXPECT_FALSE(can_be_stated(value_of(1.0, bad, 1.0, 0.1)));
    EXPECT_FALSE(can_be_stated(value_of(1.0, 0.1, 1.0, bad)));
  }
  EXPECT_FALSE(can_be_stated(value_of(nan, 0.1, 1.0, 0.1)));
  StoredValue without_k = value_of(1.0, 0.1, 1.0, 0.1);
  without_k.of_phase.k = 0.5;
  EXPECT_FALSE(can_be_stated(without_k));
}

TEST(StatedValue, SaysWhatItHoldsFor) {
  EXPECT_EQ(coverage_percent(0.9544997361036416, Language::english), "95.45 %");
  EXPECT_EQ(coverage_percent(0.9544997361036416, Language::german), "95,45 %");
  EXPECT_EQ(frequency_range({}, Language::english), "no frequency");
  EXPECT_EQ(frequency_range({value_of(1, 1, 1, 1)}, Language::german), "10 Hz");
  EXPECT_EQ(method_description("of-the-future", Language::german), "of-the-future");
  for (const char* method :
       {"analogue", "sample-timestamping", "series-timestamping", "absolute-time"}) {
    for (const Language language : all_languages) {
      EXPECT_GT(method_description(method, language).size(), 60U) << method;
    }
  }
}

} // namespace
} // namespace dyncal::inline views
