#include "drivers/virtual_bench/model/response.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "drivers/virtual_bench/model/preset.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

TEST(PchipTable, PassesThroughItsPointsAndDoesNotOvershoot) {
  const PchipTable table({0.0, 1.0, 2.0, 4.0}, {0.0, 1.0, 1.0, 3.0});
  EXPECT_DOUBLE_EQ(table.at(0.0), 0.0);
  EXPECT_DOUBLE_EQ(table.at(1.0), 1.0);
  EXPECT_DOUBLE_EQ(table.at(4.0), 3.0);
  for (double x = 1.0; x <= 2.0; x += 0.05) {
    EXPECT_NEAR(table.at(x), 1.0, 1e-12);
  }
  EXPECT_DOUBLE_EQ(table.at(-5.0), 0.0);
  EXPECT_DOUBLE_EQ(table.at(9.0), 3.0);
}

TEST(PchipTable, IsExactForAStraightLine) {
  const PchipTable table({0.0, 0.5, 3.0}, {1.0, 2.0, 7.0});
  for (double x = 0.0; x <= 3.0; x += 0.1) {
    EXPECT_NEAR(table.at(x), 1.0 + 2.0 * x, 1e-12);
  }
}

TEST(Preset, PtbUnitHasThePublishedResult) {
  const auto preset = preset_by_name("mpu9250-ptb");
  ASSERT_TRUE(preset);
  const std::complex<double> at_160 = preset->axes[2].at(160.0);
  EXPECT_NEAR(std::abs(at_160), 0.853822, 1e-9);
  EXPECT_NEAR(std::arg(at_160) * 180.0 / std::numbers::pi, -87.0253, 1e-6);
  const std::complex<double> at_46 = preset->axes[2].at(46.7);
  EXPECT_NEAR(std::abs(at_46), 1.005066, 1e-9);
  EXPECT_NEAR(std::arg(at_46) * 180.0 / std::numbers::pi, -25.4223, 1e-6);
}

TEST(Preset, PaperUnitDelaysBy8100Microseconds) {
  const auto preset = preset_by_name("mpu9250-paper");
  ASSERT_TRUE(preset);
  const std::complex<double> at_20 = preset->axes[2].at(20.0);
  EXPECT_NEAR(std::arg(at_20), -2.0 * std::numbers::pi * 20.0 * 8.1e-3, 1e-12);
}

TEST(Preset, CrossAxesSeeAboutTwoPercent) {
  for (const std::string& name : preset_names()) {
    const auto preset = preset_by_name(name);
    ASSERT_TRUE(preset) << name;
    for (const std::size_t axis : {0U, 1U}) {
      EXPECT_NEAR(std::abs(preset->axes[axis].at(80.0)), 0.02, 0.004) << name;
    }
  }
  EXPECT_FALSE(preset_by_name("mpu6050"));
}

TEST(AxisResponse, FallsLikeALowPassAboveItsTable) {
  const auto preset = preset_by_name("mpu9250-ptb");
  ASSERT_TRUE(preset);
  EXPECT_NEAR(preset->axes[2].magnitude_at(500.0), 0.64397 / 4.0, 1e-9);
  EXPECT_NEAR(preset->axes[2].magnitude_at(1.0), 1.019167, 1e-9);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
