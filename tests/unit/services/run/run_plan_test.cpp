#include "services/run/run_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::services {
namespace {

TEST(RunPlan, PlansAllFrequenciesOfARepetitionBeforeTheNext) {
  BenchFile file;
  file.bench = "acc-1";
  file.excitation.frequencies_hz = {"10", "20"};
  file.excitation.levels_m_s2 = {1.0, 2.0};
  file.excitation.repetitions = 2;
  const wire::Measurement measurement = plan_measurement(file, "r", 5, {});
  ASSERT_EQ(measurement.steps().size(), 4U);
  EXPECT_EQ(measurement.steps()[2].frequency_text_hz(), "10");
  EXPECT_EQ(measurement.steps()[2].repetition(), 2U);
  EXPECT_EQ(measurement.steps()[3].step(), 4U);
  EXPECT_DOUBLE_EQ(measurement.steps()[3].level_m_s2(), 2.0);
}

} // namespace
} // namespace dyncal::services
