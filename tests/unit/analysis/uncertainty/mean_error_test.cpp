#include "analysis/uncertainty/mean_error.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(MeanError, OneNormalDistributionAddsInSquares) {
  const CombinedUncertainty combined = combine({{{9.0, 1.0}}, {}}, 4.0);
  EXPECT_NEAR(combined.u, 5.0, 1e-12);
  EXPECT_NEAR(combined.expanded(), 10.0, 1e-12);
  EXPECT_TRUE(std::isinf(combined.degrees_of_freedom));
}

TEST(MeanError, AMixtureHasTheIntervalThatHoldsItsPart) {
  const MeanError error{{{1.0, 0.8}, {25.0, 0.2}}, {}};
  const CombinedUncertainty combined = combine(error, 0.0);
  const double half = combined.expanded();
  EXPECT_NEAR(0.8 * std::erfc(half / std::sqrt(2.0)) + 0.2 * std::erfc(half / std::sqrt(50.0)),
              1.0 - two_sigma_probability, 1e-7);
  EXPECT_GT(combined.k, 2.5);
  EXPECT_LT(combined.degrees_of_freedom, 5.0);
  EXPECT_NEAR(combined.k, coverage_factor(combined.degrees_of_freedom), 1e-9);
}

TEST(MeanError, WithoutPartsItIsStudentsT) {
  const CombinedUncertainty combined = combine({{}, {0.5, 2.0}}, 0.0);
  EXPECT_NEAR(combined.u, 0.5, 1e-12);
  EXPECT_NEAR(combined.k, 4.5265, 1e-3);
}

} // namespace
} // namespace dyncal::analysis
