#include "drivers/virtual_bench/model/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace dyncal::drivers::virtual_bench {
namespace {

TEST(Random, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
  Random random(1, "moments");
  double sum = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  constexpr int count = 400'000;
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / count, 0.0, 0.008);
  EXPECT_NEAR(square / count, 1.0, 0.01);
  EXPECT_NEAR(fourth / count, 3.0, 0.1);
}

TEST(Random, UniformNumbersStayInTheirRange) {
  Random random(1, "range");
  double sum = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(2.0, 6.0);
    ASSERT_GE(x, 2.0);
    ASSERT_LT(x, 6.0);
    sum += x / 100'000;
  }
  EXPECT_NEAR(sum, 4.0, 0.02);
}

TEST(Random, RepeatsItselfForTheSameSeedAndNameOnly) {
  Random first(1, "a");
  Random same(1, "a");
  Random other_name(1, "b");
  Random other_seed(2, "a");
  const double drawn = first.uniform();
  EXPECT_EQ(drawn, same.uniform());
  EXPECT_NE(drawn, other_name.uniform());
  EXPECT_NE(drawn, other_seed.uniform());
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
