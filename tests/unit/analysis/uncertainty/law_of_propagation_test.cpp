#include "analysis/uncertainty/law_of_propagation.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(Uncertainty, HalfWidthsBecomeStandardDeviations) {
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::normal, 2.0), 1.0);
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::rectangular, std::sqrt(3.0)), 1.0);
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::triangular, std::sqrt(6.0)), 1.0);
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::arcsine, std::sqrt(2.0)), 1.0);
}

// GUM H.1, end gauges: u_c = 32 nm, nu_eff = 16.
TEST(Uncertainty, MeetsTheEndGaugeExampleOfTheGum) {
  const std::array inputs{
      InputQuantity{.name = "standard", .u = 25.0, .degrees_of_freedom = 18.0},
      InputQuantity{.name = "repeated observations", .u = 5.8, .degrees_of_freedom = 24.0},
      InputQuantity{
          .name = "random effects of the comparator", .u = 3.9, .degrees_of_freedom = 5.0},
      InputQuantity{
          .name = "systematic effects of the comparator", .u = 6.7, .degrees_of_freedom = 8.0},
      InputQuantity{.name = "difference of expansion", .u = 2.9, .degrees_of_freedom = 50.0},
      InputQuantity{.name = "difference of temperatures", .u = 16.6, .degrees_of_freedom = 2.0}};
  const auto result = propagate_uncertainty(inputs);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->u, 32.0, 0.5);
  EXPECT_NEAR(result->degrees_of_freedom, 16.7, 0.5);
  EXPECT_NEAR(result->expanded, result->k * result->u, 1e-12);
}

TEST(Uncertainty, FullCorrelationAddsOrCancels) {
  const std::array inputs{InputQuantity{.name = "a", .u = 3.0, .sensitivity = 1.0},
                          InputQuantity{.name = "b", .u = 3.0, .sensitivity = -1.0}};
  const std::array same{InputCorrelation{0, 1, 1.0}}, opposite{InputCorrelation{0, 1, -1.0}};
  EXPECT_NEAR(propagate_uncertainty(inputs, same)->u, 0.0,
              1e-12); // a common error leaves no trace in a difference
  EXPECT_NEAR(propagate_uncertainty(inputs, opposite)->u, 6.0, 1e-12);
  EXPECT_NEAR(propagate_uncertainty(inputs)->u, std::sqrt(18.0), 1e-12);
}

TEST(Uncertainty, RefusesWhatCannotBe) {
  const std::array negative{InputQuantity{.name = "a", .u = -1.0}};
  EXPECT_FALSE(propagate_uncertainty(negative).has_value());
  const std::array without_freedom{InputQuantity{.name = "a", .u = 1.0, .degrees_of_freedom = 0.0}};
  EXPECT_FALSE(propagate_uncertainty(without_freedom).has_value());
  const std::array three{InputQuantity{.name = "a", .u = 1.0}, InputQuantity{.name = "b", .u = 1.0},
                         InputQuantity{.name = "c", .u = 1.0}};
  const std::array contradiction{InputCorrelation{0, 1, -1.0}, InputCorrelation{1, 2, -1.0},
                                 InputCorrelation{0, 2, -1.0}};
  EXPECT_FALSE(propagate_uncertainty(three, contradiction).has_value());
  const std::array missing{InputCorrelation{0, 7, 0.1}}, large{InputCorrelation{0, 1, 1.1}};
  EXPECT_FALSE(propagate_uncertainty(three, missing).has_value());
  EXPECT_FALSE(propagate_uncertainty(three, large).has_value());
}

} // namespace
} // namespace dyncal::analysis
