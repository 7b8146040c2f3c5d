#include "drivers/smartup/sensor_counts.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace dyncal::drivers::smartup {
namespace {

// Every count of the receiver has a number of its own, which must be found again.
TEST(SensorCounts, EveryCountIsInTheCommonAccount) {
  std::uint64_t next = 1;
  std::set<std::uint64_t> expected;
  const auto set = [&](auto& count) {
    count = next;
    expected.insert(next++);
  };
  SensorCounts sensor;
  for (auto* count :
       {&sensor.received, &sensor.lost_in_unit, &sensor.lost_on_way, &sensor.duplicates,
        &sensor.late, &sensor.stale, &sensor.restarts, &sensor.other_sender, &sensor.new_columns,
        &sensor.without_sync, &sensor.stamps_not_trusted}) {
    set(*count);
  }
  ReceptionCounts reception;
  for (auto* count : {&reception.dropped_by_kernel, &reception.found_lost, &reception.too_long,
                      &reception.refused}) {
    set(*count);
  }
  std::uint64_t rejected = 0;
  for (std::size_t i = 0; i < rejections; ++i) {
    set(sensor.rejected[i]);
    rejected += sensor.rejected[i];
    set(reception.rejected[i]);
  }
  for (auto& count : sensor.stamp_flags) {
    set(count);
  }
  sensor.stamp_uncertainty_ns = 50;

  const SampleCounts counts = sample_counts(sensor, reception);
  std::set<std::uint64_t> found{counts.received, counts.lost_in_device, counts.lost_on_way,
                                counts.duplicates, counts.stamps_not_trusted};
  std::set<std::string> names;
  for (const NamedCount& cause : counts.causes) {
    found.insert(cause.value);
    EXPECT_TRUE(names.insert(cause.name).second) << cause.name << " stands for two counts";
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(counts.rejected, rejected);
  EXPECT_DOUBLE_EQ(counts.clock_uncertainty_s, std::hypot(50e-9, 100e-9));
}

TEST(SensorCounts, AnUnitThatDoesNotKnowItsClockGivesNoUncertainty) {
  const SampleCounts counts = sample_counts({}, {});
  EXPECT_EQ(counts.clock_uncertainty_s, 0.0);
  EXPECT_TRUE(counts.causes.empty());
}

} // namespace
} // namespace dyncal::drivers::smartup
