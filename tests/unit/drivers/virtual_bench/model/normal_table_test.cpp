#include "drivers/virtual_bench/model/normal_table.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::uint64_t entries = std::uint64_t{1} << NormalTable::bits;

TEST(NormalTable, HasTheMomentsOfTheNormalDistribution) {
  const NormalTable table;
  double sum = 0.0;
  double squares = 0.0;
  double fourth = 0.0;
  int beyond_two = 0;
  for (std::uint64_t i = 0; i < entries; ++i) {
    const double x = table.at(i);
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    beyond_two += std::abs(x) > 2.0 ? 1 : 0;
  }
  const auto count = static_cast<double>(entries);
  EXPECT_NEAR(sum / count, 0.0, 1e-12);
  EXPECT_NEAR(squares / count, 1.0, 1e-12);
  EXPECT_NEAR(fourth / count, 3.0, 0.02);
  EXPECT_NEAR(beyond_two / count, std::erfc(std::sqrt(2.0)), 5e-4);
}

TEST(NormalTable, TakesTheLowestBitsAlone) {
  const NormalTable table;
  EXPECT_EQ(table.at(entries + 17), table.at(17));
  EXPECT_LT(table.at(0), -3.5);
  EXPECT_GT(table.at(entries - 1), 3.5);
}

TEST(NormalTable, IsWhiteWhenPickedByRandomBits) {
  const NormalTable table;
  Random random(3, "noise");
  constexpr int count = 400'000;
  double before = 0.0;
  double sum = 0.0;
  double neighbours = 0.0;
  double of_one_draw = 0.0; // two numbers of the same bits
  for (int i = 0; i < count; ++i) {
    const std::uint64_t bits = random.bits();
    const double x = table.at(bits);
    sum += x;
    neighbours += x * before;
    of_one_draw += x * table.at(bits >> NormalTable::bits);
    before = x;
  }
  const double four_sd = 4.0 / std::sqrt(count);
  EXPECT_NEAR(sum / count, 0.0, four_sd);
  EXPECT_NEAR(neighbours / count, 0.0, four_sd);
  EXPECT_NEAR(of_one_draw / count, 0.0, four_sd);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
