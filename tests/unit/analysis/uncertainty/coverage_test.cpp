#include "analysis/uncertainty/coverage.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(Coverage, InfiniteDegreesOfFreedomNeedTheFactorTwo) {
  EXPECT_NEAR(coverage_factor(infinite_degrees_of_freedom), 2.0, 1e-12);
  EXPECT_TRUE(std::isinf(coverage_factor(0.0))); // nothing is covered without any
  EXPECT_NEAR(coverage_factor(1e9), 2.0, 1e-7);
}

// Table G.2 of the GUM at 95.45 %, and 95 % values of any textbook.
TEST(Coverage, MeetsTheTableOfTheGum) {
  EXPECT_NEAR(coverage_factor(1.0), 13.97, 0.005);
  EXPECT_NEAR(coverage_factor(2.0), 4.53, 0.005);
  EXPECT_NEAR(coverage_factor(3.0), 3.31, 0.005);
  EXPECT_NEAR(coverage_factor(10.0), 2.28, 0.005);
  EXPECT_NEAR(coverage_factor(50.0), 2.05, 0.005);
  EXPECT_NEAR(coverage_factor(2.0, 0.95), 4.3026527297494624, 1e-12);
  EXPECT_NEAR(coverage_factor(9.0, 0.95), 2.2621571627982055, 1e-12);
}

// With two degrees of freedom the distribution has a closed form: F(t) = 1/2 + t / (2 sqrt(2 +
// t^2)).
TEST(Coverage, StudentsDistributionHasItsClosedForms) {
  for (const double t : {-5.0, -0.3, 0.0, 0.7, 12.0}) {
    EXPECT_NEAR(student_probability(t, 2.0), 0.5 + t / (2.0 * std::sqrt(2.0 + t * t)), 1e-14) << t;
    EXPECT_NEAR(student_probability(t, 1.0), 0.5 + std::atan(t) / 3.14159265358979323846, 1e-14)
        << t;
  }
}

TEST(Coverage, RealDegreesOfFreedomAreNotTruncated) {
  EXPECT_NEAR(coverage_factor(13.685), 2.2002045284421407, 1e-12);
}

TEST(Coverage, EffectiveDegreesOfFreedomFollowWelchAndSatterthwaite) {
  const std::array parts{UncertaintyPart{3.0, 9.0}, UncertaintyPart{4.0}};
  EXPECT_DOUBLE_EQ(effective_degrees_of_freedom(parts), 625.0 / 9.0);
  const std::array known{UncertaintyPart{3.0}};
  EXPECT_EQ(effective_degrees_of_freedom(known), infinite_degrees_of_freedom);
}

TEST(Coverage, PartsAreCombinedWithTheFactorOfTheirDegreesOfFreedom) {
  const std::array known{UncertaintyPart{3.0}, UncertaintyPart{4.0}};
  EXPECT_EQ(combine(known).expanded(), 10.0);
  const std::array one{UncertaintyPart{3.0, 4.0}, UncertaintyPart{}};
  EXPECT_NEAR(combine(one).k, coverage_factor(4.0), 1e-12);
  const std::array both{UncertaintyPart{3.0, 9.0}, UncertaintyPart{4.0}};
  EXPECT_GT(combine(both).k, coverage_factor(625.0 / 9.0));
  EXPECT_LT(combine(both).expanded(), std::hypot(coverage_factor(9.0) * 3.0, 8.0));
  EXPECT_EQ(combine({}).u, 0.0);
}

} // namespace
} // namespace dyncal::analysis
