#include "analysis/uncertainty/distribution.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(Distribution, EveryNameLeadsBack) {
  for (const Distribution distribution : {Distribution::normal, Distribution::rectangular,
                                          Distribution::triangular, Distribution::arcsine}) {
    EXPECT_EQ(parse_distribution(to_string(distribution)), distribution);
  }
  EXPECT_EQ(parse_distribution("Normal"), std::nullopt);
  EXPECT_EQ(parse_distribution(""), std::nullopt);
}

TEST(Distribution, HalfWidthsBecomeStandardDeviations) {
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::normal, 6.0), 3.0);
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::rectangular, 6.0), 6.0 / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::triangular, 6.0), 6.0 / std::sqrt(6.0));
  EXPECT_DOUBLE_EQ(standard_uncertainty(Distribution::arcsine, 6.0), 6.0 / std::sqrt(2.0));
}

} // namespace
} // namespace dyncal::analysis
