#include "services/run/level_settling.hpp"

#include <gtest/gtest.h>

#include "services/evaluation/record/channel_level.hpp"

namespace dyncal::inline run {
namespace {

TEST(LevelSettling, IsPlannedOnlyWhereTheLevelIsControlled) {
  BenchFile bench;
  bench.excitation.settling_s = 0.5;
  bench.generator.driver = GeneratorDriver::scpi;
  EXPECT_EQ(planned_settling_s(bench, 10.0, 1), 0.5);
  bench.generator.level_tolerance_rel = 0.01;
  const double one_measurement_s = 0.5 + level_transport_s + level_window_s(10.0) + 0.5;
  EXPECT_NEAR(planned_settling_s(bench, 10.0, 1), 0.5 + 4.0 * one_measurement_s, 1e-12);
  EXPECT_NEAR(planned_settling_s(bench, 10.0, 2), 0.5 + 2.0 * one_measurement_s, 1e-12);
  EXPECT_GT(level_window_s(1.0), level_window_s(100.0));
}

} // namespace
} // namespace dyncal::inline run
