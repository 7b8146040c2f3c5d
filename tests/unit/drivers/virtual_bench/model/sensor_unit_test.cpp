#include "drivers/virtual_bench/model/sensor_unit.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit/drivers/virtual_bench/model/interval_statistics.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double gravity = 9.80665;

SensorUnitSettings settings(const std::string& preset, double highest_level_m_s2) {
  SensorUnitSettings result;
  result.preset = *preset_by_name(preset);
  result.seed = 4;
  result.start_ns = 1'600'000'000'000'000'000;
  result.highest_level_m_s2 = highest_level_m_s2;
  return result;
}

std::vector<UnitSample> samples_of(SensorUnit& unit, const Excitation& excitation,
                                   double duration_s) {
  std::vector<UnitSample> samples;
  while (auto sample = unit.next_before(duration_s, excitation)) {
    samples.push_back(*sample);
  }
  return samples;
}

std::vector<double> column(const std::vector<UnitSample>& samples, std::size_t index) {
  std::vector<double> values;
  for (const UnitSample& sample : samples) {
    values.push_back(static_cast<double>(sample.data[index].value()));
  }
  return values;
}

TEST(SensorUnit, ChoosesTheSmallestRangeThatHoldsTheLevel) {
  EXPECT_NEAR(SensorUnit(settings("mpu9250-paper", 5.0)).range_m_s2(), 2.0 * gravity, 1e-9);
  EXPECT_NEAR(SensorUnit(settings("mpu9250-paper", 10.0)).range_m_s2(), 4.0 * gravity, 1e-9);
  EXPECT_NEAR(SensorUnit(settings("mpu9250-paper", 127.0)).range_m_s2(), 16.0 * gravity, 1e-9);
}

TEST(SensorUnit, Mpu9250HasNoiseAndStepOfItsDataSheet) {
  SensorUnit unit(settings("mpu9250-paper", 10.0));
  const Excitation excitation{ExciterModel{}};
  const auto samples = samples_of(unit, excitation, 60.0);
  const std::vector<double> z = column(samples, 2);
  EXPECT_NEAR(statistics_of(z).sd, 300e-6 * gravity * std::sqrt(0.5 / 996.96e-6), 0.05 * 0.066);
  EXPECT_NEAR(statistics_of(z).mean, gravity, 1.0);
  const double step = 1.0 / 8192.0 * gravity;
  for (const double value : z) {
    ASSERT_NEAR(value / step, std::rint(value / step), 1e-3);
  }
}

TEST(SensorUnit, Bma280MeasuresThreeAxesTemperatureAndAdcs) {
  SensorUnit unit(settings("bma280", 10.0));
  const Excitation excitation{ExciterModel{}};
  const auto samples = samples_of(unit, excitation, 20.0);
  for (std::size_t i = 0; i < unit_channels; ++i) {
    EXPECT_EQ(samples.front().data[i].has_value(), i < 3 || (i >= 9 && i <= 12)) << i;
  }
  EXPECT_NEAR(statistics_of(column(samples, 0)).sd, 120e-6 * gravity * std::sqrt(0.5 / 485e-6),
              0.05 * 0.0379);
  EXPECT_NEAR(statistics_of(column(samples, 9)).mean, 25.0, 0.1);
}

TEST(SensorUnit, CountsItsSamplesFromOne) {
  SensorUnit unit(settings("mpu9250-paper", 10.0));
  const Excitation excitation{ExciterModel{}};
  std::uint32_t expected = 1;
  for (const UnitSample& sample : samples_of(unit, excitation, 1.0)) {
    EXPECT_EQ(sample.sample_number, expected++);
  }
  EXPECT_EQ(expected, 995U); // 994 samples in the 0.99 s from the first edge on
}

TEST(SensorUnit, SyncAdcReportsInputVoltsTimesItsGainInTwelveBits) {
  SensorUnit unit(settings("mpu9250-paper", 10.0));
  Excitation excitation{ExciterModel{}};
  excitation.change(0.0, {97.0, 0.2, true});
  const std::vector<double> sync = column(samples_of(unit, excitation, 10.0), 10);
  const IntervalStatistics found = statistics_of(sync);
  EXPECT_NEAR(found.sd * std::sqrt(2.0), 9.75 * 0.166245, 0.01 * 1.62);
  const double step = 20.0 / 4096.0 * 0.166245;
  for (const double value : sync) {
    ASSERT_NEAR(value / step, std::rint(value / step), 1e-3);
  }
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
