#include "analysis/clock/slip_spacing.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(SlipSpacing, LossesAsRegularAsTicksAreUnsure) {
  std::mt19937_64 random(41);
  std::exponential_distribution<double> late(20.0); // of the distance
  for (int draw = 0; draw < 100; ++draw) {
    SlipSpacing slips;
    for (int i = 1; i <= 10; ++i) {
      const auto sample = static_cast<std::uint64_t>(200.0 * (i - late(random)));
      slips.add(sample, i % 2 == 0 ? 1 : 0); // every second was understood as a tick
    }
    EXPECT_EQ(slips.unsure_losses(), 5U) << "draw " << draw;
  }
}

TEST(SlipSpacing, LossesAtRandomAreSure) {
  std::mt19937_64 random(42);
  int unsure = 0;
  for (int draw = 0; draw < 500; ++draw) {
    SlipSpacing slips;
    std::uint64_t sample = 0;
    for (int i = 0; i < 10; ++i) {
      sample += 1 + static_cast<std::uint64_t>(std::exponential_distribution(0.005)(random));
      slips.add(sample, 1);
    }
    unsure += slips.unsure_losses() > 0 ? 1 : 0;
  }
  EXPECT_LE(unsure, 10);
}

TEST(SlipSpacing, FewTellNothing) {
  SlipSpacing slips;
  EXPECT_EQ(slips.unsure_losses(), 0U);
  for (const std::uint64_t sample : {10U, 17U, 900U}) {
    slips.add(sample, 2);
  }
  EXPECT_EQ(slips.unsure_losses(), 6U);
}

TEST(SlipSpacing, TakesBackWhatWasALatency) {
  SlipSpacing slips;
  for (std::uint64_t i = 1; i <= 6; ++i) {
    slips.add(100 * i, 1);
    slips.add(100 * i + 30, 0);
    slips.take_back();
  }
  EXPECT_EQ(slips.unsure_losses(), 6U);
}

} // namespace
} // namespace dyncal::analysis
