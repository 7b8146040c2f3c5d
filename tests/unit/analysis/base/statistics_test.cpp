#include "analysis/base/statistics.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(Statistics, TheUpperMedianIsOneOfTheValues) {
  std::vector<double> odd{5.0, 1.0, 3.0};
  EXPECT_EQ(upper_median(odd), 3.0);
  std::vector<std::int64_t> even{4, 1, 3, 2};
  EXPECT_EQ(upper_median(even), 3);
  std::vector<double> one{7.0};
  EXPECT_EQ(upper_median(one), 7.0);
}

TEST(Statistics, TheMedianOfAnEvenNumberLiesInTheMiddle) {
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 2.5);
  EXPECT_EQ(median({5.0, 1.0, 3.0}), 3.0);
}

TEST(Statistics, QuantilesAreValuesOrLieBetweenThem) {
  const std::vector<double> values{40.0, 10.0, 30.0, 20.0};
  EXPECT_EQ(quantile_value(values, 0.5), 20.0);
  EXPECT_EQ(quantile_value(values, 0.0), 10.0);
  EXPECT_EQ(quantile_value(values, 1.0), 40.0);
  const std::array sorted{10.0, 20.0, 30.0, 40.0};
  EXPECT_EQ(quantile_of_sorted(sorted, 0.5), 25.0);
  EXPECT_EQ(quantile_of_sorted(sorted, 0.0), 10.0);
  EXPECT_EQ(quantile_of_sorted(sorted, 1.0), 40.0);
}

TEST(Statistics, TheStandardDeviationDividesByNMinusOne) {
  const std::array values{2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0};
  EXPECT_EQ(mean(values), 5.0);
  EXPECT_DOUBLE_EQ(standard_deviation(values), std::sqrt(32.0 / 7.0));
  EXPECT_DOUBLE_EQ(mean_repeats({1.0, 2.0, 1.0, 1.0, 3.0, 2.0}), 1.0);
  EXPECT_DOUBLE_EQ(mean_repeats({1.0, 2.0, 3.0}), 0.0);
}

} // namespace
} // namespace dyncal::analysis
