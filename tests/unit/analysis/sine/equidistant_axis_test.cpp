#include "analysis/sine/equidistant_axis.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// Frequency times stamp is the phase in turns that frequency times true time would give.
TEST(EquidistantAxis, KeepsThePhaseOfEverySample) {
  for (const double interval_s : {1.0 / 3200.0, 0.3e-9, 1e-3, 996.96e-6}) {
    const EquidistantAxis axis(interval_s);
    const auto stamps_ns = axis.stamps_ns(10'001);
    ASSERT_EQ(stamps_ns.size(), 10'001u);
    EXPECT_EQ(stamps_ns.front(), 0);
    const double hz = 0.01 / interval_s;
    const double turns = axis.on_axis(hz).hz() * static_cast<double>(stamps_ns.back()) * 1e-9;
    EXPECT_NEAR(turns, 100.0, 1e-11) << interval_s;
  }
}

TEST(EquidistantAxis, ConvertsFrequenciesBack) {
  const EquidistantAxis axis(1.0 / 3200.0);
  EXPECT_NEAR(axis.hz(axis.on_axis(80.0).hz()), 80.0, 1e-12);
  const EquidistantAxis third(1.0 / 3000.0); // not a whole number of nanoseconds
  EXPECT_NE(third.on_axis(80.0).hz(), 80.0);
  EXPECT_NEAR(third.hz(third.on_axis(80.0).hz()), 80.0, 1e-12);
}

} // namespace
} // namespace dyncal::analysis
