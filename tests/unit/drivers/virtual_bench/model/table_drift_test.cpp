#include "drivers/virtual_bench/model/table_drift.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::drivers::virtual_bench {
namespace {

TEST(TableDrift, MovesByMicronsInSecondsAndHums) {
  int forward = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const TableDrift drift(seed);
    EXPECT_GE(std::abs(drift.velocity_m_s()), 0.05e-6);
    EXPECT_LE(std::abs(drift.velocity_m_s()), 0.15e-6);
    forward += drift.velocity_m_s() > 0.0 ? 1 : 0;
    double low_m = drift.at(0.0);
    double high_m = low_m;
    for (double at_s = 0.0; at_s < 10.0; at_s += 0.05) {
      low_m = std::min(low_m, drift.at(at_s));
      high_m = std::max(high_m, drift.at(at_s));
    }
    EXPECT_GT(high_m - low_m, 2e-6) << seed;
    EXPECT_LT(high_m - low_m, 40e-6) << seed;
    EXPECT_DOUBLE_EQ(drift.motions().back().amplitude_m, 2e-9);
    EXPECT_DOUBLE_EQ(drift.motions().back().frequency_hz, 49.98);
  }
  EXPECT_GT(forward, 5);
  EXPECT_LT(forward, 35);
}

// Else a sensor on the table would have to show it.
TEST(TableDrift, IsTooSlowToBeAnAcceleration) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const TableDrift drift(seed);
    double largest_m_s2 = 0.0;
    for (const SlowMotion& motion : drift.motions()) {
      const double w = 2.0 * 3.141592653589793 * motion.frequency_hz;
      largest_m_s2 += w * w * motion.amplitude_m;
    }
    EXPECT_LT(largest_m_s2, 1e-3) << seed;
  }
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
