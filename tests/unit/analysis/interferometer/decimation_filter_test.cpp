#include "analysis/interferometer/decimation_filter.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

std::vector<double> sine(double cycles_per_sample, std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(
        std::sin(2.0 * std::numbers::pi * cycles_per_sample * static_cast<double>(i) + 0.7));
  }
  return values;
}

// A sine comes out as itself times the gain, at the stated instants.
void expect_exact_gain(std::size_t factor, double new_cycles) {
  DecimationFilter filter(factor);
  const double cycles = new_cycles / static_cast<double>(filter.factor());
  std::vector<double> decimated;
  filter.push(sine(cycles, 30 * factor), decimated);
  ASSERT_GT(decimated.size(), 10u) << factor;
  const double gain = filter.gain(cycles);
  for (std::size_t m = 0; m < decimated.size(); ++m) {
    const auto at = static_cast<double>(filter.first_sample() + m * filter.factor());
    EXPECT_NEAR(decimated[m], gain * std::sin(2.0 * std::numbers::pi * cycles * at + 0.7), 1e-12)
        << factor;
  }
}

TEST(DecimationFilter, ItsGainIsExact) {
  for (const std::size_t factor : {1u, 2u, 3u, 25u, 512u, 513u, 3000u}) {
    expect_exact_gain(factor, 0.24);
    expect_exact_gain(factor, 0.125);
  }
}

TEST(DecimationFilter, PassesTheStepAndStopsWhatWouldFoldOntoIt) {
  for (const std::size_t factor : {2u, 40u, 3000u}) {
    const DecimationFilter filter(factor);
    const auto by_new_rate = [&](double cycles) {
      return std::abs(filter.gain(cycles / static_cast<double>(filter.factor())));
    };
    EXPECT_NEAR(by_new_rate(0.0), 1.0, 1e-14);
    EXPECT_GT(by_new_rate(0.24), 0.98);
    for (double cycles = 0.75; cycles < 1.0; cycles += 0.01) {
      EXPECT_LT(by_new_rate(cycles), 4e-4) << cycles;
    }
  }
}

TEST(DecimationFilter, BlocksOfAnySizeGiveTheSameBits) {
  const auto values = sine(1e-4, 100000);
  for (const std::size_t factor : {7u, 900u}) {
    DecimationFilter at_once(factor);
    std::vector<double> expected;
    at_once.push(values, expected);
    DecimationFilter in_blocks(factor);
    std::vector<double> decimated;
    std::size_t begin = 0;
    for (std::size_t n = 1; begin < values.size(); n = n % 5000 + 37) {
      const std::size_t size = std::min(n, values.size() - begin);
      in_blocks.push(std::span(values).subspan(begin, size), decimated);
      begin += size;
    }
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(decimated, expected);
  }
}

} // namespace
} // namespace dyncal::analysis
